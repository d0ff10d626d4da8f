// What lanes (core/lanes/lanes.hpp) have to say to code that takes one at a time: masks of
// comparisons.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/lanes/lanes.hpp"

namespace vdwmesh {

// Sets bit i of the result if lane i is true: all bits of a lane are alike, so its sign tells.
VDWMESH_INLINE std::uint32_t bits_of(const LaneBits& lanes) {
#if defined(__SSE2__)
  using Half = double __attribute__((vector_size(16)));
  Half low, high;
  std::memcpy(&low, &lanes, sizeof low);
  std::memcpy(&high, reinterpret_cast<const char*>(&lanes) + sizeof low, sizeof high);
  const int bits = __builtin_ia32_movmskpd(low) | __builtin_ia32_movmskpd(high) << 2;
  return static_cast<std::uint32_t>(bits);
#else
  const LaneBits bits = lanes & LaneBits{1, 2, 4, 8};
  return static_cast<std::uint32_t>(bits[0] | bits[1] | bits[2] | bits[3]);
#endif
}

// The same of eight lanes, those of `low` first.
VDWMESH_INLINE std::uint32_t bits_of(const LaneBits& low, const LaneBits& high) {
  return bits_of(low) | bits_of(high) << kLanes;
}

// A mask of eight lanes of 32 bits each, where all bits of a lane are alike.
using EightMasks = std::int32_t __attribute__((vector_size(8 * sizeof(std::int32_t))));

// The same of these. It has a name of its own, because Clang takes vectors of as many bytes for
// each other.
VDWMESH_INLINE std::uint32_t bits_of_eight(const EightMasks& lanes) {
#if defined(__SSE2__)
  using Half = float __attribute__((vector_size(16)));
  Half low, high;
  std::memcpy(&low, &lanes, sizeof low);
  std::memcpy(&high, reinterpret_cast<const char*>(&lanes) + sizeof low, sizeof high);
  const int bits = __builtin_ia32_movmskps(low) | __builtin_ia32_movmskps(high) << 4;
  return static_cast<std::uint32_t>(bits);
#else
  const EightMasks bits = lanes & EightMasks{1, 2, 4, 8, 16, 32, 64, 128};
  std::uint32_t found = 0;
  for (std::size_t lane = 0; lane < 8; ++lane) found |= static_cast<std::uint32_t>(bits[lane]);
  return found;
#endif
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
