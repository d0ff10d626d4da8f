// Which pairs of a cell's balls may meet: what most simplices of a triangulation are rejected by.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "complex/power_triangulation.hpp"

namespace vdwmesh {

// Bit p of a pair mask stands for kPairs[p]. kFacetPairs[k] holds the three pairs on the facet
// opposite to vertex k.
inline constexpr std::uint8_t kAllPairs = 63;
inline constexpr std::array<std::uint8_t, 4> kFacetPairs{{0b111000, 0b100110, 0b010101, 0b001011}};

// Whether all of `bits` are set in the mask.
inline bool contains(std::uint8_t mask, std::uint8_t bits) { return (mask & bits) == bits; }

// Returns the mask of pairs whose balls may meet. This is a floating-point filter: it may keep a
// pair whose balls do not meet, but never drops one whose balls do. kSlack exceeds the rounding
// of both sides (a few 1e-16); kTiny covers squares that underflow; NaN keeps the pair.
inline std::uint8_t overlapping_pairs(const PowerTriangulation& t,
                                      const std::array<std::uint32_t, 4>& cell) {
  constexpr double kSlack = 1 + 0x1p-40, kTiny = 1e-280;
  std::uint8_t mask = 0;
  for (std::size_t p = 0; p < 6; ++p) {
    const std::uint32_t i = cell[kPairs[p][0]], j = cell[kPairs[p][1]];
    if (!t.is_ball(i) || !t.is_ball(j)) continue;
    const Sphere &a = t.balls[i], &b = t.balls[j];
    const double reach = a.radius + b.radius;
    if (!(squared_norm(b.center - a.center) > kSlack * reach * reach + kTiny)) {
      mask = static_cast<std::uint8_t>(mask | (1u << p));
    }
  }
  return mask;
}

}  // namespace vdwmesh
