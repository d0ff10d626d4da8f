// Morton codes (Z-order): numbers of the cells of a regular grid along a curve on which cells with
// near numbers are mostly near each other.
#pragma once

#include <cstdint>

namespace vdwmesh {

// Moves bit i of x to bit 3i, for the lower 21 bits; all other bits of the result are 0. Each line
// splits every group of bits into two halves and moves the upper half away from the lower one, by
// 32, 16, 8, 4 and 2 bits; the mask removes the copies that | leaves behind. The operator << binds
// tighter than |.
constexpr std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 32) & 0x001f00000000ffffu;
  x = (x | x << 16) & 0x001f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

// The code of the cell with these numbers along the axes, each below 2^21: their bits alternate.
constexpr std::uint64_t morton_code(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spread_bits(x) | spread_bits(y) << 1 | spread_bits(z) << 2;
}

}  // namespace vdwmesh
