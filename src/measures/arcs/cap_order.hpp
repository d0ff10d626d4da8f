// The caps of a ball in the order of cuts_deeper().
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "core/lanes/lanes.hpp"
#include "measures/arcs/arc_cap.hpp"

namespace vdwmesh::arcs {

// Keeps its memory from ball to ball.
class CapOrder {
 public:
  // Returns the indices of the caps in the order of cuts_deeper(). The span is valid until the next
  // call.
  std::span<const std::uint32_t> sort(std::span<const Cap> caps);

 private:
  using Keys = std::int32_t __attribute__((vector_size(32)));
  static constexpr std::size_t kKeys = 8;  // keys in a vector
  // Comparing every pair beats sorting by branches, which the processor cannot foresee, for so many
  // caps; and their indices fit into the low bits of a key.
  static constexpr std::size_t kMostRanked = 128;

  bool rank(std::span<const Cap> caps);

  std::vector<std::uint32_t> order_;
};

// A sort key: the cosine in steps of 2^-18, and the index of the cap in the lower bits, so that
// keys are distinct. NaN counts as -1; the cut by that cap raises the doubt kNotFinite.
inline std::int32_t sort_key(const Cap& cap, std::size_t index) {
  constexpr double kSteps = 1 << 18;
  const double cosine = cap.cosine > -1 ? (cap.cosine < 1 ? cap.cosine : 1) : -1;
  return static_cast<std::int32_t>(kSteps * (cosine + 1)) * 2048 + static_cast<std::int32_t>(index);
}

// The rank of a cap is the number of smaller keys. Returns whether the cosines rise from cap to
// cap: then the order is right.
VDWMESH_INLINE bool CapOrder::rank(std::span<const Cap> caps) {
  alignas(Keys) std::int32_t keys[kMostRanked];
  double cosines[kMostRanked + kLanes];  // by rank
  const std::size_t count = caps.size();
  for (std::size_t i = 0; i < count; ++i) keys[i] = sort_key(caps[i], i);
  for (std::size_t i = count; i % (2 * kKeys) != 0; ++i) keys[i] = 0;
  std::uint32_t* const order = order_.data();
  for (std::size_t first = 0; first < count; first += 2 * kKeys) {
    Keys low, high, low_ranks{}, high_ranks{};
    std::memcpy(&low, keys + first, sizeof low);
    std::memcpy(&high, keys + first + kKeys, sizeof high);
    for (std::size_t j = 0; j < count; ++j) {
      const Keys other = Keys{} + keys[j];
      low_ranks -= other < low;  // -1 in each lane if so
      high_ranks -= other < high;
    }
    std::int32_t ranks[2 * kKeys];
    std::memcpy(ranks, &low_ranks, sizeof low_ranks);
    std::memcpy(ranks + kKeys, &high_ranks, sizeof high_ranks);
    const std::size_t last = std::min(first + 2 * kKeys, count);
    for (std::size_t i = first; i < last; ++i) {
      order[ranks[i - first]] = static_cast<std::uint32_t>(i);
      cosines[ranks[i - first]] = caps[i].cosine;
    }
  }
  // Behind the last cosine stand larger ones.
  store_lanes(cosines + count, all_lanes(2));
  LaneBits rises = ~LaneBits{};
  for (std::size_t i = 0; i + 1 < count; i += kLanes) {
    rises &= (lanes_at(cosines + i) < lanes_at(cosines + i + 1)) | (lanes_at(cosines + i) > 1);
  }
  return (rises[0] & rises[1] & rises[2] & rises[3]) != 0;
}

inline std::span<const std::uint32_t> CapOrder::sort(std::span<const Cap> caps) {
  const auto deeper = [&](std::uint32_t a, std::uint32_t b) {
    return cuts_deeper(caps[a], caps[b]);
  };
  order_.resize(caps.size());
  if (caps.size() > kMostRanked) {
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), deeper);
    return order_;
  }
  if (rank(caps)) return order_;
  // What the steps of the keys left in disorder is put in order by insertion.
  for (std::size_t i = 1; i < order_.size(); ++i) {
    for (std::size_t k = i; k > 0 && deeper(order_[k], order_[k - 1]); --k) {
      std::swap(order_[k], order_[k - 1]);
    }
  }
  return order_;
}

}  // namespace vdwmesh::arcs
