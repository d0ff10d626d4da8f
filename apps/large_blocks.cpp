// Large blocks of all containers, those inside gemmi among them, in large pages: memory touched for
// the first time is half the cost of reading a large file. Not built where the sanitizers have
// their own operators.
#include <cstdlib>
#include <new>

#include "core/large_pages.hpp"

namespace {
constexpr std::size_t kLargeBlock = std::size_t{4} << 20;  // bytes: two large pages
}

void* operator new(std::size_t bytes) {
  void* block = std::malloc(bytes > 0 ? bytes : 1);
  while (block == nullptr) {
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
    block = std::malloc(bytes > 0 ? bytes : 1);
  }
  if (bytes >= kLargeBlock) vdwmesh::advise_large_pages(block, bytes);
  return block;
}

void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
