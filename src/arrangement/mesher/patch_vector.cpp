// Memory of PatchVector, from a pool of oneTBB's allocator that lies on large pages; from the C
// library's under the sanitizers, which follow only that.
#include "arrangement/mesher/patch_vector.hpp"

#include <new>

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define VDWMESH_SANITIZED
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define VDWMESH_SANITIZED
#endif

#if defined(VDWMESH_SANITIZED) || !defined(__linux__)
#include <cstdlib>
#else
#include <sys/mman.h>
#include <tbb/scalable_allocator.h>

#include "core/large_pages.hpp"
#endif

namespace vdwmesh {
namespace {

#if defined(VDWMESH_SANITIZED) || !defined(__linux__)

void* take(std::size_t bytes) { return std::malloc(bytes); }
void give(void* memory) noexcept { std::free(memory); }

#else

// The memory of a pool: whole large pages, so that the kernel can map each at its first write. The
// pool asks for multiples of them. Null if there is none.
void* take_large_pages(std::intptr_t, std::size_t& bytes) {
  // One large page more, of which the parts before and after the whole ones are given back.
  const std::size_t room = bytes + kLargePage;
  void* const mapped =
      mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return nullptr;
  char* const begin = static_cast<char*>(mapped);
  char* const first = const_cast<char*>(whole_pages(begin, room, kLargePage).first);
  const auto before = static_cast<std::size_t>(first - begin);
  if (before > 0) (void)munmap(begin, before);
  if (before < kLargePage) (void)munmap(first + bytes, kLargePage - before);
  advise_large_pages(first, bytes);
  return first;
}
int give_large_pages(std::intptr_t, void* memory, std::size_t bytes) {
  return munmap(memory, bytes);
}

// It is never destroyed, since arrays may be freed at the end of the program.
rml::MemoryPool* pool() {
  static rml::MemoryPool* const made = [] {
    const rml::MemPoolPolicy policy(take_large_pages, give_large_pages, kLargePage);
    rml::MemoryPool* pool = nullptr;
    if (rml::pool_create_v1(0, &policy, &pool) != rml::POOL_OK) throw std::bad_alloc();
    return pool;
  }();
  return made;
}

void* take(std::size_t bytes) { return rml::pool_malloc(pool(), bytes); }
void give(void* memory) noexcept { (void)rml::pool_free(pool(), memory); }

#endif

}  // namespace

void* take_patch_memory(std::size_t bytes) {
  void* const memory = take(bytes);
  if (!memory && bytes > 0) throw std::bad_alloc();
  return memory;
}

void give_patch_memory(void* memory) noexcept { give(memory); }

}  // namespace vdwmesh
