// The caps of a ball in the order of cuts_deeper().
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <span>
#include <vector>

#include "arrangement/arcs/arc_cap.hpp"
#include "core/lanes.hpp"

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

  void rank(std::span<const Cap> caps);

  std::vector<std::uint32_t> order_;
};

// The cosine, in steps of 2^-18, with the index below it: keys are distinct. A NaN counts as -1;
// what comes of it is told when the cap is cut off.
inline std::int32_t sort_key(const Cap& cap, std::size_t index) {
  constexpr double kSteps = 1 << 18;
  const double cosine = cap.cosine > -1 ? (cap.cosine < 1 ? cap.cosine : 1) : -1;
  return static_cast<std::int32_t>(kSteps * (cosine + 1)) * 2048 + static_cast<std::int32_t>(index);
}

// The rank of a cap is the number of smaller keys.
VDWMESH_INLINE void CapOrder::rank(std::span<const Cap> caps) {
  alignas(Keys) std::int32_t keys[kMostRanked];
  const std::size_t count = caps.size();
  for (std::size_t i = 0; i < count; ++i) keys[i] = sort_key(caps[i], i);
  for (std::size_t i = count; i % kKeys != 0; ++i) keys[i] = 0;
  for (std::size_t first = 0; first < count; first += kKeys) {
    Keys own, ranks{};
    std::memcpy(&own, keys + first, sizeof own);
    for (std::size_t j = 0; j < count; ++j) ranks -= keys[j] < own;  // -1 in each lane if so
    const std::size_t last = std::min(first + kKeys, count);
    for (std::size_t i = first; i < last; ++i) {
      order_[static_cast<std::size_t>(ranks[i - first])] = static_cast<std::uint32_t>(i);
    }
  }
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
  rank(caps);
  // What the steps of the keys left in disorder is put in order by insertion.
  for (std::size_t i = 1; i < order_.size(); ++i) {
    for (std::size_t k = i; k > 0 && deeper(order_[k], order_[k - 1]); --k) {
      std::swap(order_[k], order_[k - 1]);
    }
  }
  return order_;
}

}  // namespace vdwmesh::arcs
