// A hint to the kernel; the program does the same without it.
#pragma once

#include <cstddef>

namespace vdwmesh {

// Asks for large pages under an array that is not touched yet.
void advise_large_pages(const void* begin, std::size_t bytes);

template <class T>
void advise_large_pages(const T* begin, std::size_t count) {
  advise_large_pages(static_cast<const void*>(begin), count * sizeof(T));
}

}  // namespace vdwmesh
