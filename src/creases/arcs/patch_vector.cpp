// Memory of PatchVector, from oneTBB's allocator; from the C library's under the sanitizers, which
// follow only that.
#include "creases/arcs/patch_vector.hpp"

#include <new>

#include "core/large_pages.hpp"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VDWMESH_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VDWMESH_SANITIZED
#endif

#ifdef VDWMESH_SANITIZED
#include <cstdlib>
#else
#include <tbb/scalable_allocator.h>
#endif

namespace vdwmesh {

// Blocks of this size, two large pages, are those of a patch of some 100,000 triangles. A fault for
// each small page is a fifth of the time of such a patch.
constexpr std::size_t kLargeBlock = 2 * kLargePage;

void* take_patch_memory(std::size_t bytes) {
#ifdef VDWMESH_SANITIZED
  void* const memory = std::malloc(bytes);
#else
  void* const memory = scalable_malloc(bytes);
#endif
  if (!memory && bytes > 0) throw std::bad_alloc();
  if (bytes >= kLargeBlock) advise_large_pages(memory, bytes);
  return memory;
}

void give_patch_memory(void* memory) noexcept {
#ifdef VDWMESH_SANITIZED
  std::free(memory);
#else
  scalable_free(memory);
#endif
}

}  // namespace vdwmesh
