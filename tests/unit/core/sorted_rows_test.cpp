// Rows filled on all cores beside a map that is filled in order.
#include "core/order/sorted_rows.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

namespace vdwmesh {
namespace {

// Item i has i % 4 entries, in rows of its own choice; rows of odd numbers stay empty.
void expect_rows_of_a_map(std::size_t rows, std::size_t items, std::size_t threads) {
  SCOPED_TRACE(::testing::Message() << rows << " rows, " << items << ", threads " << threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::mt19937_64 random(rows + items);
  std::vector<std::vector<std::pair<std::size_t, std::uint32_t>>> of_item(items);
  std::map<std::size_t, std::vector<std::uint32_t>> expected;
  for (std::size_t i = 0; i < items; ++i) {
    for (std::size_t k = 0; k < i % 4; ++k) {
      const std::size_t row = random() % rows / 2 * 2;
      of_item[i].emplace_back(row, static_cast<std::uint32_t>(random() % 1000));
      expected[row].push_back(of_item[i].back().second);
    }
  }
  SortedRows<std::uint32_t> found;
  // Twice, since rows are refilled.
  for (int run = 0; run < 2; ++run) {
    found.fill(rows, items, [&](std::size_t i, const auto& add) {
      for (const auto& [row, entry] : of_item[i]) add(row, entry);
    });
    ASSERT_EQ(found.size(), rows);
    std::size_t entries = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      std::ranges::sort(expected[r]);
      ASSERT_TRUE(std::ranges::equal(found[r], expected[r])) << r;
      entries += expected[r].size();
    }
    EXPECT_EQ(found.entries().size(), entries);
  }
}

TEST(SortedRows, AnyThreadsGiveTheRowsOfAMap) {
  for (const std::size_t threads : {1u, 3u, 8u}) {
    expect_rows_of_a_map(1, 0, threads);
    expect_rows_of_a_map(2, 3'000, threads);
    expect_rows_of_a_map(700, 20'001, threads);
  }
  EXPECT_EQ(SortedRows<int>().size(), 0u);
}

}  // namespace
}  // namespace vdwmesh
