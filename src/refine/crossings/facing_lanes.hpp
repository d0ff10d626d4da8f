// Finds of four triangles of one atom those that face outward for certain, all four at once, so
// that facing() in refine/subdivision_formulas.hpp is asked of the others alone: of hardly any.
//
// facing() computes the triangle's vector area a and a vector o from the atom's centre outward, and
// says outward unless a · o, as computed, is negative. Here the same operations give the same a and
// o, and s, the sum of the products a_i o_i without fused operations. Let S be Σ |a_i o_i| and
// ε = 2^-53. Three products and two sums round s, so it is within 3 ε S (1 + ε)² of the exact a ·
// o, and so is the a · o of facing(), which rounds three times. The computed S is at least (1 - ε)³
// of the exact one. So if s exceeds 8 ε S as computed, facing() computes a positive number.
// Products below 2^-1022 lose 2^-1075 at most, of which kUnderflow is far more. If something
// overflows or is not a number, the comparison fails, and nothing is certain.
#pragma once

#include <cstdint>

#include "core/lanes/lane_masks.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// One corner of each of the four triangles, by axis.
struct LaneCorner {
  Lanes axis[3];
};

VDWMESH_INLINE LaneCorner lane_corner(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                      const Vec3d& d) {
  return {{Lanes{a.x, b.x, c.x, d.x}, Lanes{a.y, b.y, c.y, d.y}, Lanes{a.z, b.z, c.z, d.z}}};
}

// A mask of the triangles that face outward for certain. corner(k, lane) is the position of corner
// k of a triangle; `center` is that of the sphere of all corners.
template <class CornerAt>
VDWMESH_INLINE std::uint32_t outward_for_certain(const Vec3d& center, const CornerAt& corner) {
  constexpr double kRounding = 0x1p-50, kUnderflow = 0x1p-1010;
  const LaneCorner p = lane_corner(corner(0, 0), corner(0, 1), corner(0, 2), corner(0, 3)),
                   q = lane_corner(corner(1, 0), corner(1, 1), corner(1, 2), corner(1, 3)),
                   r = lane_corner(corner(2, 0), corner(2, 1), corner(2, 2), corner(2, 3));
  const double origin[3] = {center.x, center.y, center.z};
  Lanes u[3], v[3], out[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes c = all_lanes(origin[axis]);
    u[axis] = q.axis[axis] - p.axis[axis];
    v[axis] = r.axis[axis] - p.axis[axis];
    out[axis] = ((p.axis[axis] - c) + (q.axis[axis] - c)) + (r.axis[axis] - c);
  }
  Lanes sum = all_lanes(0), size = all_lanes(0);
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    const Lanes term = (u[j] * v[k] - u[k] * v[j]) * out[axis];
    sum += term;
    size += magnitude_of(term);
  }
  return bits_of(sum > kRounding * size + kUnderflow);
}

}  // namespace vdwmesh
