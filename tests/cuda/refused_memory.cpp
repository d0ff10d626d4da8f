// Stands before the runtime's cudaMallocFromPoolAsync(). The toolkit's headers are not needed: an
// error is an int and a stream a pointer.
#include "cuda/refused_memory.hpp"

#include <dlfcn.h>

#include <atomic>
#include <cstddef>

namespace vdwmesh::testing {
namespace {

std::atomic<int> refusals = 0;
constexpr int kMemoryAllocation = 2;  // cudaErrorMemoryAllocation

}  // namespace

RefusedMemory::RefusedMemory() { ++refusals; }
RefusedMemory::~RefusedMemory() { --refusals; }

extern "C" int cudaMallocFromPoolAsync(void** memory, std::size_t bytes, void* pool, void* stream) {
  if (refusals > 0) return kMemoryAllocation;
  using Allocate = int (*)(void**, std::size_t, void*, void*);
  static const auto allocate =
      reinterpret_cast<Allocate>(dlsym(RTLD_NEXT, "cudaMallocFromPoolAsync"));
  return allocate(memory, bytes, pool, stream);
}

}  // namespace vdwmesh::testing
