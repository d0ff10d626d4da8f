// Numbers of vertices of a mesh that many ranks share.
#include "distributed/together/vertex_numbers.hpp"

#include <gtest/gtest.h>

#include <array>

namespace vdwmesh {
namespace {

constexpr std::uint64_t kNames = std::uint64_t{1} << 32;

// Three generations of four ranks, of which one has no vertices at first and another none later.
constexpr std::array<std::array<std::uint64_t, 4>, 3> kCounts = {
    {{0, 5, 3, 2}, {4, 0, 1, 6}, {kNames, kNames + 1, 0, 2}}};

VertexNumbers numbers_of_rank(std::size_t rank) {
  VertexNumbers numbers(rank);
  for (const auto& counts : kCounts) numbers.append(counts);
  return numbers;
}

// Generation by generation, rank by rank.
TEST(VertexNumbers, RunsStandBehindEachOther) {
  std::uint64_t next = 0;
  std::array<std::size_t, 4> own{};
  for (std::size_t g = 0; g < kCounts.size(); ++g) {
    for (std::size_t rank = 0; rank < 4; ++rank) {
      const VertexNumbers::Run run = numbers_of_rank(rank).runs()[g];
      EXPECT_EQ(run.first, next);
      EXPECT_EQ(run.begin, own[rank]);
      own[rank] += kCounts[g][rank];
      EXPECT_EQ(run.end, own[rank]);
      next += kCounts[g][rank];
    }
  }
  EXPECT_EQ(numbers_of_rank(0).whole(), next);
  for (std::size_t rank = 0; rank < 4; ++rank) EXPECT_EQ(numbers_of_rank(rank).own(), own[rank]);
}

// The first and the last vertex of every run, as their owner and as all others see them.
TEST(VertexNumbers, EveryVertexHasOneOwner) {
  for (std::size_t owner = 0; owner < 4; ++owner) {
    const VertexNumbers of_owner = numbers_of_rank(owner);
    for (const auto& [first, begin, end] : of_owner.runs()) {
      if (begin == end) continue;
      for (const std::size_t place : {begin, end - 1}) {
        const std::uint64_t number = of_owner.number_of(place);
        EXPECT_EQ(number, first + (place - begin));
        for (std::size_t rank = 0; rank < 4; ++rank) {
          const VertexNumbers numbers = numbers_of_rank(rank);
          EXPECT_EQ(numbers.owner_of(number), owner);
          const auto expected = rank == owner ? std::optional(place) : std::nullopt;
          EXPECT_EQ(numbers.own_vertex(number), expected);
        }
      }
    }
  }
}

}  // namespace
}  // namespace vdwmesh
