// Hints to the kernel and the allocator; the program does the same without them.
#pragma once

#include <algorithm>
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

// The whole pages of `page` bytes in [begin, begin + bytes).
struct PageRange {
  const char *first, *last;
};

inline PageRange whole_pages(const void* begin, std::size_t bytes, std::size_t page) {
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::size_t before = std::min(bytes, (page - address % page) % page);
  const std::size_t after = std::min(bytes - before, (address + bytes) % page);
  const char* const bytes_of = static_cast<const char*>(begin);
  return {bytes_of + before, bytes_of + (bytes - after)};
}

inline constexpr std::size_t kPage = 4096;                       // bytes
inline constexpr std::size_t kLargePage = std::size_t{2} << 20;  // bytes

// Asks for large pages under an array that is not touched yet: a first touch then costs a third.
// Where the kernel declines, nothing changes.
inline void advise_large_pages([[maybe_unused]] const void* begin,
                               [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  const auto [first, last] = whole_pages(begin, bytes, kPage);
  if (last > first)
    (void)madvise(const_cast<char*>(first), static_cast<std::size_t>(last - first), MADV_HUGEPAGE);
#endif
}

template <class T>
void advise_large_pages(const T* begin, std::size_t count) {
  advise_large_pages(static_cast<const void*>(begin), count * sizeof(T));
}

// Has the kernel hand out pages at once, which takes a fraction of a fault for each.
inline void touch_pages([[maybe_unused]] const char* first, [[maybe_unused]] const char* last) {
#ifdef MADV_POPULATE_WRITE
  if (last > first)
    (void)madvise(const_cast<char*>(first), static_cast<std::size_t>(last - first),
                  MADV_POPULATE_WRITE);
#endif
}

// For an array that is not touched yet and about to be written in full: large pages where they
// fit, and the small ones at both ends, some MB at most, at once.
template <class T>
void expect_writing(const T* begin, std::size_t count) {
  constexpr std::size_t kFew = 1 << 16;  // bytes, not worth the calls
  const std::size_t bytes = count * sizeof(T);
  if (bytes < kFew) return;
  advise_large_pages(begin, count);
  const PageRange all = whole_pages(begin, bytes, kPage);
  const PageRange large = whole_pages(begin, bytes, kLargePage);
  touch_pages(all.first, std::min(all.last, large.first));
  touch_pages(large.last, all.last);
}

// resize() of an array that is about to be written once, in large pages where it can have them.
template <class T>
void resize_untouched(Buffer<T>& array, std::size_t count) {
  array.resize(count);
  expect_writing(array.data(), count);
}

// Gives the pages of freed small blocks back, of which the allocator keeps what lies between blocks
// in use: worth its milliseconds between many small blocks and a few large ones.
inline void return_freed_pages() {
#ifdef __GLIBC__
  (void)malloc_trim(0);
#endif
}

}  // namespace vdwmesh
