// Boxes of the four parts of a patch side by side, for tests of all parts of one patch against all
// of another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "core/lanes/lane_masks.hpp"
#include "core/lanes/lanes.hpp"

namespace vdwmesh {

// In single precision, Å, relative to the origin of the grid that has them (patch_grid.hpp), by
// axis and part.
struct PartBoxes {
  float lower[3][4], upper[3][4];

  // Bit 4 a + b tells whether part a of this patch and part b of the other one have boxes with a
  // point in common.
  std::uint32_t overlapping(const PartBoxes& other) const;

 private:
  using Four = float __attribute__((vector_size(4 * sizeof(float))));
  using Eight = float __attribute__((vector_size(8 * sizeof(float))));

  static VDWMESH_INLINE Four four_at(const float* first) {
    Four four;
    std::memcpy(&four, first, sizeof four);
    return four;
  }
  // Both halves hold all four numbers.
  static VDWMESH_INLINE Eight twice(const Four& four) {
    return __builtin_shufflevector(four, four, 0, 1, 2, 3, 0, 1, 2, 3);
  }
  // The first half holds number `part`, the second half the next one.
  template <int part>
  static VDWMESH_INLINE Eight two_of(const Four& four) {
    constexpr int next = part + 1;
    return __builtin_shufflevector(four, four, part, part, part, part, next, next, next, next);
  }
  // Bits 0 to 3 of the result are of part `part`, bits 4 to 7 of the next one.
  template <int part>
  std::uint32_t overlapping_two(const PartBoxes& other) const;
};

template <int part>
VDWMESH_INLINE std::uint32_t PartBoxes::overlapping_two(const PartBoxes& other) const {
  EightMasks all = EightMasks{} - 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all &= two_of<part>(four_at(lower[axis])) <= twice(four_at(other.upper[axis]));
    all &= two_of<part>(four_at(upper[axis])) >= twice(four_at(other.lower[axis]));
  }
  return bits_of_eight(all);
}

VDWMESH_INLINE std::uint32_t PartBoxes::overlapping(const PartBoxes& other) const {
  return overlapping_two<0>(other) | overlapping_two<2>(other) << 8;
}

}  // namespace vdwmesh
