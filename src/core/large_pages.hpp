// Hints to the kernel and the allocator; the program does the same without them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/buffer.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace vdwmesh {

// Asks for large pages under an array that is not touched yet: a first touch then costs a third.
// Where the kernel declines, nothing changes.
inline void advise_large_pages([[maybe_unused]] const void* begin,
                               [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t kPage = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + kPage - 1) / kPage * kPage;
  const std::uintptr_t last = (address + bytes) / kPage * kPage;
  if (last <= first) return;
  const char* pages = static_cast<const char*>(begin) + (first - address);
  (void)madvise(const_cast<char*>(pages), last - first, MADV_HUGEPAGE);
#endif
}

template <class T>
void advise_large_pages(const T* begin, std::size_t count) {
  advise_large_pages(static_cast<const void*>(begin), count * sizeof(T));
}

// resize() of an array that is about to be written once, in large pages where it can have them.
template <class T>
void resize_untouched(Buffer<T>& array, std::size_t count) {
  array.resize(count);
  advise_large_pages(array.data(), count);
}

// Gives the pages of freed small blocks back, of which the allocator keeps what lies between blocks
// in use: worth its milliseconds between many small blocks and a few large ones.
inline void return_freed_pages() {
#ifdef __GLIBC__
  (void)malloc_trim(0);
#endif
}

}  // namespace vdwmesh
