// The whole pages within an array, and what the system is asked for them. This program's madvise()
// notes each call and passes it on.
#include "core/large_pages.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <vector>

namespace {

struct Advice {
  const char *first, *last;
  int what;
};
std::vector<Advice>* noted = nullptr;  // null: not now

}  // namespace

extern "C" int madvise(void* begin, std::size_t bytes, int what) noexcept {
  const auto* const first = static_cast<const char*>(begin);
  if (noted) noted->push_back({first, first + bytes, what});
  return static_cast<int>(syscall(SYS_madvise, begin, bytes, what));
}

namespace vdwmesh {
namespace {

// An array of so many bytes, 3 bytes behind a page's beginning, between two large pages.
std::vector<Advice> advice_for(std::size_t bytes, const char*& array) {
  constexpr std::size_t kRoom = std::size_t{16} << 20;
  void* const room =
      ::mmap(nullptr, kRoom, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  EXPECT_NE(room, MAP_FAILED);
  array = whole_pages(room, kRoom, kLargePage).first + kPage + 3;
  std::vector<Advice> given;
  noted = &given;
  expect_writing(array, bytes);
  noted = nullptr;
  ::munmap(room, kRoom);
  return given;
}

// Large pages are asked for under all whole pages, and the small ones at both ends are mapped.
TEST(ExpectWriting, AsksForLargePagesAndMapsTheEnds) {
  const char* array = nullptr;
  const auto given = advice_for(2 * kLargePage, array);  // holds one large page
  const char* const large = array - 3 - kPage + kLargePage;
  const char* const first = array - 3 + kPage;
  const char* const last = array - 3 + 2 * kLargePage;
  ASSERT_EQ(given.size(), 3u);
  EXPECT_EQ(given[0].what, MADV_HUGEPAGE);
  EXPECT_EQ(given[0].first, first);
  EXPECT_EQ(given[0].last, last);
  EXPECT_EQ(given[1].what, MADV_POPULATE_WRITE);
  EXPECT_EQ(given[1].first, first);
  EXPECT_EQ(given[1].last, large);
  EXPECT_EQ(given[2].what, MADV_POPULATE_WRITE);
  EXPECT_EQ(given[2].first, large + kLargePage);
  EXPECT_EQ(given[2].last, last);
}

TEST(ExpectWriting, LeavesSmallArraysAlone) {
  const char* array = nullptr;
  EXPECT_TRUE(advice_for(1000, array).empty());
}

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
