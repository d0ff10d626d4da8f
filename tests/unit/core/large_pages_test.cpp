// The whole pages within an array.
#include "core/large_pages.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace vdwmesh {
namespace {

TEST(WholePages, LieWithinTheArray) {
  constexpr std::size_t page = 4096;
  const char* const start = reinterpret_cast<const char*>(std::uintptr_t{page} * 1000);
  for (const std::size_t offset : {std::size_t{0}, std::size_t{1}, page - 1}) {
    for (const std::size_t bytes : {std::size_t{0}, page - 2, page, 2 * page, 5 * page + 7}) {
      const PageRange range = whole_pages(start + offset, bytes, page);
      // Pages are numbered from `start`: the first that begins in the array, the last that ends.
      const std::size_t first = (offset + page - 1) / page, last = (offset + bytes) / page;
      if (last <= first) {
        EXPECT_LE(range.last, range.first) << offset << " " << bytes;
        continue;
      }
      EXPECT_EQ(range.first, start + first * page) << offset << " " << bytes;
      EXPECT_EQ(range.last, start + last * page) << offset << " " << bytes;
    }
  }
}

}  // namespace
}  // namespace vdwmesh
