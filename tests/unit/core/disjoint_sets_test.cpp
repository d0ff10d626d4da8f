// Sets joined by many threads at once are those that one thread would make.
#include "core/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

Pairs random_pairs(std::uint32_t members, std::size_t count) {
  std::mt19937 random(3);
  Pairs pairs(count);
  for (auto& pair : pairs)
    for (std::uint32_t& i : pair) i = static_cast<std::uint32_t>(random() % members);
  return pairs;
}

// The smallest member of each set, by passing smaller names on until nothing changes.
std::vector<std::uint32_t> smallest_members(std::uint32_t members, const Pairs& pairs) {
  std::vector<std::uint32_t> name(members);
  for (std::uint32_t i = 0; i < members; ++i) name[i] = i;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : pairs) {
      const std::uint32_t smaller = std::min(name[a], name[b]);
      changed = changed || name[a] != smaller || name[b] != smaller;
      name[a] = name[b] = smaller;
    }
  }
  return name;
}

void expect_sets(DisjointSets& sets, const std::vector<std::uint32_t>& names) {
  std::size_t roots = 0;
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    ASSERT_EQ(sets.find(i), names[i]) << i;
    roots += names[i] == i;
  }
  EXPECT_EQ(sets.count(), roots);
}

TEST(DisjointSets, OneThread) {
  // From sets of one to a single one.
  for (const std::size_t count : {0u, 100u, 2000u, 5000u, 40'000u}) {
    SCOPED_TRACE(count);
    const Pairs pairs = random_pairs(5000, count);
    DisjointSets sets(5000);
    for (const auto& [a, b] : pairs) sets.join(a, b);
    expect_sets(sets, smallest_members(5000, pairs));
  }
}

TEST(DisjointSets, ManyThreads) {
  constexpr std::size_t kThreads = 4;
  for (const std::size_t count : {2000u, 5000u, 40'000u}) {
    SCOPED_TRACE(count);
    const Pairs pairs = random_pairs(5000, count);
    const std::vector<std::uint32_t> names = smallest_members(5000, pairs);
    for (int run = 0; run < 20; ++run) {
      DisjointSets sets(5000);
      {
        std::vector<std::jthread> threads;
        for (std::size_t first = 0; first < kThreads; ++first)
          threads.emplace_back([&sets, &pairs, first] {
            for (std::size_t i = first; i < pairs.size(); i += kThreads)
              sets.join(pairs[i][0], pairs[i][1]);
          });
      }
      expect_sets(sets, names);
    }
  }
}

TEST(DisjointSets, NumbersBySmallestMember) {
  DisjointSets sets(6);
  sets.join(5, 1);
  sets.join(4, 3);
  sets.join(3, 5);
  Buffer<std::uint32_t> number;
  EXPECT_EQ(std::move(sets).number_sets(number), 3u);
  EXPECT_EQ(number, (Buffer<std::uint32_t>{0, 1, 2, 1, 1, 1}));
}

// Indices are of 32 bits, so a loop over 2^32 elements would not end.
TEST(DisjointSets, RefuseMoreElementsThanTheyCount) {
  EXPECT_THROW(DisjointSets(std::size_t{1} << 32), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
