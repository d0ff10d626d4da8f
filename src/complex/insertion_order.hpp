// The order in which balls are inserted into a triangulation. For the library's own use.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <ranges>
#include <vector>

#include "core/order/split_mix.hpp"

namespace vdwmesh {

// Returns the order of insertion of `count` balls in spatial order: a biased randomized insertion
// order (Amenta, Choi, Rote 2003). A hash of the index chooses the round: three zero bits at its
// end move a ball one round ahead. So the last round, rounds[0], has 7/8 of the balls, the one
// before it 7/8 of the rest, and so on. Each round is in spatial order.
inline std::vector<std::uint32_t> insertion_order(std::size_t count) {
  constexpr int kBitsPerRound = 3, kRounds = 6;
  std::array<std::vector<std::uint32_t>, kRounds> rounds;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t hash = split_mix((i + 1) * kSplitMixStep);
    const int round = std::min(std::countr_zero(hash) / kBitsPerRound, kRounds - 1);
    rounds[static_cast<std::size_t>(round)].push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> order;
  order.reserve(count);
  for (const auto& round : std::views::reverse(rounds)) {
    order.insert(order.end(), round.begin(), round.end());
  }
  return order;
}

}  // namespace vdwmesh
