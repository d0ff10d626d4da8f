// Loops over fixed blocks, with none, one, a full block and one index more or less than that: what
// they number, add and collect stands in the order of the indices.
#include "core/fixed_blocks.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace vdwmesh {
namespace {

class FixedBlocks : public testing::TestWithParam<std::size_t> {
 protected:
  std::size_t count() const { return GetParam(); }
};

bool is_third(std::size_t i) { return i % 3 == 0; }

std::vector<std::size_t> thirds_below(std::size_t count) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < count; i += 3) all.push_back(i);
  return all;
}

TEST_P(FixedBlocks, CoverTheRangeOnce) {
  std::vector<int> visits(count(), 0);
  for_each_block(count(), kIndicesPerBlock,
                 [&](std::size_t block, std::size_t first, std::size_t end) {
                   EXPECT_EQ(first, block * kIndicesPerBlock);
                   for (std::size_t i = first; i < end; ++i) ++visits[i];
                 });
  EXPECT_EQ(visits, std::vector<int>(count(), 1));
}

TEST_P(FixedBlocks, NumberTheCountedIndicesInOrder) {
  std::vector<std::size_t> numbered(thirds_below(count()).size());
  const std::uint32_t total =
      number_all(count(), is_third, [&](std::size_t i, std::uint32_t n) { numbered.at(n) = i; });
  EXPECT_EQ(total, numbered.size());
  EXPECT_EQ(numbered, thirds_below(count()));
}

TEST_P(FixedBlocks, AddTheItemsInOrder) {
  std::vector<std::size_t> indices, items;
  const auto make = [](std::size_t i) { return 7 * i; };
  make_and_add(count(), make, [&](std::size_t i, std::size_t item) {
    indices.push_back(i);
    items.push_back(item);
  });
  std::vector<std::size_t> expected(count());
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  EXPECT_EQ(indices, expected);
  for (std::size_t& i : expected) i *= 7;
  EXPECT_EQ(items, expected);
}

TEST_P(FixedBlocks, CollectInOrder) {
  const auto add = [](std::size_t i, std::vector<std::size_t>& found) {
    if (is_third(i)) found.push_back(i);
  };
  EXPECT_EQ(collect<std::size_t>(count(), add), thirds_below(count()));
}

INSTANTIATE_TEST_SUITE_P(Counts, FixedBlocks,
                         testing::Values(0, 1, kIndicesPerBlock - 1, kIndicesPerBlock,
                                         kIndicesPerBlock + 1, 5 * kIndicesPerBlock + 7));

}  // namespace
}  // namespace vdwmesh
