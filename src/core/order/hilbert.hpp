// Hilbert keys: numbers of the cells of a regular grid along Hilbert's curve, on which each cell
// has a face in common with the next one.
//
// The cells of one run of numbers are therefore connected, and have less surface than those of a
// run of Morton codes (morton.hpp), which jumps.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "core/order/morton.hpp"

namespace vdwmesh {

inline constexpr int kHilbertBits = 21;  // of a cell's number along an axis

// The key of the cell with these numbers along the axes, each below 2^21; it is below 2^63. By
// Skilling (2004, "Programming the Hilbert curve"): from the highest bit down, the cube is turned
// and mirrored as its octant asks, then the Gray code is undone.
VDWMESH_HD constexpr std::uint64_t hilbert_key(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  for (std::uint32_t bit = 1u << (kHilbertBits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    if ((x & bit) != 0) x ^= below;
    const auto exchange_or_mirror = [&x, bit, below](std::uint32_t& axis) {
      const std::uint32_t change = (axis & bit) != 0 ? 0 : (x ^ axis) & below;
      if ((axis & bit) != 0) x ^= below;
      x ^= change;
      axis ^= change;
    };
    exchange_or_mirror(y);
    exchange_or_mirror(z);
  }
  y ^= x;
  z ^= y;
  std::uint32_t turned = 0;
  for (std::uint32_t bit = 1u << (kHilbertBits - 1); bit > 1; bit >>= 1) {
    if ((z & bit) != 0) turned ^= bit - 1;
  }
  return spread_bits(x ^ turned) << 2 | spread_bits(y ^ turned) << 1 | spread_bits(z ^ turned);
}

}  // namespace vdwmesh
