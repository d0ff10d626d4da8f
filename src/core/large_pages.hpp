// Hints to the operating system and the allocator about the pages of large arrays.
//
// The first write to each page of new memory is a page fault, and for large arrays these faults
// take a large part of the time. Two hints reduce it: transparent huge pages (2 MiB instead of
// 4 KiB for one fault) and MADV_POPULATE_WRITE, which maps many pages in one system call. The
// functions ignore errors and do nothing on other systems: results are the same without the hints.
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

// An address range that begins and ends at page boundaries; empty if first == last.
struct PageRange {
  const char *first, *last;
};

// Returns the range of all whole pages of `page` bytes within [begin, begin + bytes). `before` and
// `after` are the bytes at both ends that no whole page contains. If there is no whole page, the
// result is an empty range whose position is between begin and begin + bytes.
inline PageRange whole_pages(const void* begin, std::size_t bytes, std::size_t page) {
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::size_t before = std::min(bytes, (page - address % page) % page);
  const std::size_t after = std::min(bytes - before, (address + bytes) % page);
  const char* const bytes_of = static_cast<const char*>(begin);
  return {bytes_of + before, bytes_of + (bytes - after)};
}

inline constexpr std::size_t kPage = 4096;                       // bytes
inline constexpr std::size_t kLargePage = std::size_t{2} << 20;  // bytes

// Asks the kernel for large pages under an array that has not been written yet. The first writes to
// the array then take a third of the time. The kernel may decline.
inline void advise_large_pages([[maybe_unused]] const void* begin,
                               [[maybe_unused]] std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  const auto [first, last] = whole_pages(begin, bytes, kPage);
  if (last > first)
    (void)madvise(const_cast<char*>(first), static_cast<std::size_t>(last - first), MADV_HUGEPAGE);
#endif
}

// The same for an array of `count` elements.
template <class T>
void advise_large_pages(const T* begin, std::size_t count) {
  advise_large_pages(static_cast<const void*>(begin), count * sizeof(T));
}

// Maps the pages of [first, last) with one system call, which is cheaper than one page fault for
// each of them. The contents do not change. Does nothing if the range is empty.
inline void touch_pages([[maybe_unused]] const char* first, [[maybe_unused]] const char* last) {
#ifdef MADV_POPULATE_WRITE
  if (last > first)
    (void)madvise(const_cast<char*>(first), static_cast<std::size_t>(last - first),
                  MADV_POPULATE_WRITE);
#endif
}

// Prepares an array that has not been written yet and is about to be written in full. Its whole
// 2 MiB blocks are requested as large pages, which are mapped when they are first written. The
// parts before and after these blocks, less than 2 MiB each, are mapped at once in small pages.
template <class T>
void expect_writing(const T* begin, std::size_t count) {
  constexpr std::size_t kFew = 1 << 16;  // bytes; smaller arrays are not worth the system calls
  const std::size_t bytes = count * sizeof(T);
  if (bytes < kFew) return;
  advise_large_pages(begin, count);
  const PageRange all = whole_pages(begin, bytes, kPage);
  const PageRange large = whole_pages(begin, bytes, kLargePage);
  touch_pages(all.first, std::min(all.last, large.first));
  touch_pages(large.last, all.last);
}

// Resizes an array that is about to be written in full, without a write to new elements, and
// prepares its pages by expect_writing().
template <class T>
void resize_untouched(Buffer<T>& array, std::size_t count) {
  array.resize(count);
  expect_writing(array.data(), count);
}

// Returns freed pages to the operating system. glibc keeps the free pages that lie between small
// blocks in use, and a large allocation cannot use them. The call takes milliseconds. It lowers the
// peak memory after a stage with many small blocks and before a stage with a few large ones.
inline void return_freed_pages() {
#ifdef __GLIBC__
  (void)malloc_trim(0);
#endif
}

}  // namespace vdwmesh
