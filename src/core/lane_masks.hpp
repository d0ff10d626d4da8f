// What lanes (core/lanes.hpp) have to say to code that takes one at a time: masks of comparisons.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/lanes.hpp"

namespace vdwmesh {

// Sets bit i of the result if lane i is true.
VDWMESH_INLINE std::uint32_t bits_of(const LaneBits& lanes) {
  const LaneBits bits = lanes & LaneBits{1, 2, 4, 8};
  return static_cast<std::uint32_t>(bits[0] | bits[1] | bits[2] | bits[3]);
}

// The same of eight lanes, those of `low` first.
VDWMESH_INLINE std::uint32_t bits_of(const LaneBits& low, const LaneBits& high) {
  const LaneBits bits = (low & LaneBits{1, 2, 4, 8}) | (high & LaneBits{16, 32, 64, 128});
  return static_cast<std::uint32_t>(bits[0] | bits[1] | bits[2] | bits[3]);
}

VDWMESH_INLINE LaneBits bits_at(const std::int64_t* first) {
  LaneBits lanes;
  std::memcpy(&lanes, first, sizeof lanes);
  return lanes;
}

VDWMESH_INLINE LaneBits all_bits(std::int64_t value) {
  return LaneBits{value, value, value, value};
}

// The magnitudes: the bits of the lanes without their signs.
VDWMESH_INLINE Lanes magnitude_of(const Lanes& x) {
  return std::bit_cast<Lanes>(std::bit_cast<LaneBits>(x) &
                              all_bits(std::numeric_limits<std::int64_t>::max()));
}

}  // namespace vdwmesh
