// Sorting into groups beside std::stable_sort, for counts of one block and of many.
#include "core/order/stable_groups.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <random>

namespace vdwmesh {
namespace {

void expect_stable_sort(std::size_t count, std::size_t groups, std::size_t threads) {
  SCOPED_TRACE(::testing::Message() << count << " in " << groups << ", threads " << threads);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  std::mt19937_64 random(count + groups);
  std::vector<std::size_t> group(count), expected(count), found(count);
  for (std::size_t& g : group) g = random() % groups;
  std::iota(expected.begin(), expected.end(), std::size_t{0});
  std::ranges::stable_sort(expected, {}, [&](std::size_t i) { return group[i]; });
  const std::vector<std::uint32_t> first = sort_into_groups(
      count, groups, [&](std::size_t i) { return group[i]; },
      [&](std::size_t i, std::uint32_t position) { found[position] = i; });
  EXPECT_EQ(found, expected);
  ASSERT_EQ(first.size(), groups + 1);
  for (std::size_t g = 0; g <= groups; ++g) {
    const auto before = std::ranges::count_if(group, [&](std::size_t own) { return own < g; });
    ASSERT_EQ(first[g], before);
  }
}

TEST(StableGroups, AnyThreadsGiveTheStableSort) {
  for (const std::size_t threads : {1u, 3u, 8u}) {
    for (const std::size_t count : {0u, 1u, 4096u, 4097u, 300'001u}) {
      for (const std::size_t groups : {1u, 7u, 512u}) expect_stable_sort(count, groups, threads);
    }
  }
}

TEST(StableGroups, UsualGroupsArePowersOfTwo) {
  EXPECT_EQ(usual_groups(0), 1u);
  EXPECT_EQ(usual_groups(31), 1u);
  EXPECT_EQ(usual_groups(32), 2u);
  EXPECT_EQ(usual_groups(std::size_t{1} << 32), 2048u);
}

}  // namespace
}  // namespace vdwmesh
