// Whether a plane keeps two patches apart, so that no triangle of one crosses a triangle of the
// other.
//
// A patch has a wall for each edge of its corners' triangle: a plane through the ends u and v of
// the edge. If the edge has a midpoint m, the wall goes through m as well. The edges of a single
// triangle have no midpoints; their walls are at right angles to the triangle. A wall is usable if
// all vertices of the patch but u, v and m lie strictly on one side of it, the inner side. It keeps
// another patch out if all vertices of that patch lie strictly on the outer side, except those that
// are u, v or m themselves.
//
// Claim: then no triangle s of this patch crosses a triangle t of the other. Proof: s lies in the
// closed half-space on the inner side and t in the one on the outer side, so they meet in the wall
// at most. In the wall s has at most one of the edges u m and m v (or u v) or an end of one, and so
// has t. The points u, m and v are not in one line, because the wall would not be usable then. So
// two different edges have only m in common. What s and t have in common is therefore an edge or a
// vertex of both, or nothing. The proof uses only where the triangles are now: it holds on every
// level, in every pass, for any labels.
//
// Rounding. Sides are computed in double. Let no coordinate be farther than w from the origin, and
// let ε = 2^-53, e = v - u, and d the vector from the middle of u and v to m, or the normal of the
// triangle. Coordinates lose ε w when they are taken from the origin, so e and d lose up to 4 ε w
// in each coordinate (a normal loses nothing, because any plane through u and v would do). The
// normal of the wall n = e × d then loses up to 20 ε w (|e| + |d|), and the side n · (x - u), with
// |x - u| < 4 w, loses less than 2^9 ε w² (|e| + |d|), with sums of magnitudes for lengths. A point
// counts as strictly on a side from 2^13 ε w² (|e| + |d|) on (kStrictly).
//
// The four children of one divided triangle share vertices, too: each corner child has an edge in
// common with the middle child, and two corner children have a midpoint in common. Two corner
// children are kept apart by the plane through their common midpoint and the corner that neither of
// them has, at right angles to the corners' triangle, if their other vertices lie strictly on
// different sides. Any plane through the midpoint would do, so only the sides are rounded, not the
// plane.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/lanes/lane_masks.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

class PatchOutline {
 public:
  // Takes a patch of three vertices, or of six: the corners, then for k = 0, 1, 2 the midpoint of
  // the edge from corner k to the next one. Positions (Å) are relative to an origin near the
  // patches that are compared; no coordinate is larger than `reach`.
  template <std::size_t kVertices>
  void set(const std::array<std::uint32_t, kVertices>& vertex,
           const std::array<Vec3d, kVertices>& position, double reach);

  // Whether planes keep the three corner children apart. Precondition: the patch has six vertices.
  bool separates_children(double reach) const;

  // Whether a wall of this patch keeps out another one, which must have as many vertices.
  template <std::size_t kVertices>
  bool keeps_out(const PatchOutline& other) const;

 private:
  static constexpr double kStrictly = 0x1p-40;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  // Positions by axis and lane. Lanes 0 to 4 hold corners 0, 1, 2, 0, 1, and lanes 8 to 12 the
  // midpoints in the same order. So the vector of four lanes from lane 0, 1 or 2 on holds the
  // corners in turn from that corner on, and all three edges are computed at once.
  alignas(32) double position_[3][16] = {};
  // The vertices of lanes 0 to 3 and 8 to 11, which have all vertices of the patch.
  std::array<std::uint32_t, 8> vertex_;
  // By edge: the normal n of the wall, towards the inner side, and the limit below which n · x is
  // for every point x strictly on the outer side. It is minus infinity for a wall that is not
  // usable.
  alignas(32) double normal_[3][kLanes], limit_[kLanes];
};

VDWMESH_INLINE void cross_lanes(const Lanes (&a)[3], const Lanes (&b)[3], Lanes (&product)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    product[axis] = a[j] * b[k] - a[k] * b[j];
  }
}

template <std::size_t kVertices>
VDWMESH_INLINE void PatchOutline::set(const std::array<std::uint32_t, kVertices>& vertex,
                                      const std::array<Vec3d, kVertices>& position, double reach) {
  static_assert(kVertices == 3 || kVertices == 6);
  for (std::size_t kind = 0; kind < kVertices; kind += 3) {
    const std::size_t lane = kind == 0 ? 0 : 8, bit = kind == 0 ? 0 : 4;
    for (std::size_t k = 0; k < 5; ++k) {
      const std::size_t v = kind + k % 3;
      for (int axis = 0; axis < 3; ++axis) position_[axis][lane + k] = position[v][axis];
      if (k < 4) vertex_[bit + k] = vertex[v];
    }
  }
  Lanes edge[3], up[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes u = lanes_at(&position_[axis][0]), v = lanes_at(&position_[axis][1]);
    edge[axis] = v - u;
    if constexpr (kVertices == 6) up[axis] = lanes_at(&position_[axis][8]) - 0.5 * (u + v);
  }
  if constexpr (kVertices == 3) {
    // The edges from corners 0 and 1, in all lanes.
    Lanes first[3], second[3];
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = all_lanes(edge[axis][0]);
      second[axis] = all_lanes(edge[axis][1]);
    }
    cross_lanes(first, second, up);
  }
  Lanes normal[3];
  cross_lanes(edge, up, normal);
  // The sides of the vertices that are not on the edge: the third corner and the other two
  // midpoints.
  const auto along = [&](std::size_t lane) {
    return normal[0] * lanes_at(&position_[0][lane]) + normal[1] * lanes_at(&position_[1][lane]) +
           normal[2] * lanes_at(&position_[2][lane]);
  };
  const Lanes of_edge = along(0), third = along(2) - of_edge;  // n · u, and n · (third corner - u)
  Lanes least = third, most = third;
  if constexpr (kVertices == 6) {
    for (const std::size_t lane : {std::size_t{9}, std::size_t{10}}) {
      const Lanes side = along(lane) - of_edge;
      least = side < least ? side : least;
      most = side > most ? side : most;
    }
  }
  Lanes size = all_lanes(0);
  for (int axis = 0; axis < 3; ++axis) size += magnitude_of(edge[axis]) + magnitude_of(up[axis]);
  const Lanes strictly = kStrictly * reach * reach * size;
  const Lanes sign = least > strictly ? all_lanes(1) : all_lanes(-1);
  const LaneBits is_usable = (least > strictly) | (most < -strictly);
  for (int axis = 0; axis < 3; ++axis) store_lanes(normal_[axis], sign * normal[axis]);
  store_lanes(limit_, is_usable ? sign * of_edge - strictly : all_lanes(-kInfinity));
}

VDWMESH_INLINE bool PatchOutline::separates_children(double reach) const {
  Lanes across[3], up[3], to_third[3], plane[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double *const corner = position_[axis], *const middle = corner + 8;
    across[axis] = all_lanes(corner[1] - corner[0]);
    up[axis] = all_lanes(corner[2] - corner[0]);
    to_third[axis] = lanes_at(corner + 2) - lanes_at(middle);
  }
  Lanes normal[3];
  cross_lanes(across, up, normal);
  cross_lanes(to_third, normal, plane);
  Lanes size = all_lanes(0);
  const auto along = [&](std::size_t lane) {
    return plane[0] * lanes_at(&position_[0][lane]) + plane[1] * lanes_at(&position_[1][lane]) +
           plane[2] * lanes_at(&position_[2][lane]);
  };
  for (int axis = 0; axis < 3; ++axis) size += magnitude_of(plane[axis]);
  const Lanes strictly = kStrictly * reach * size, of_middle = along(8);
  const LaneBits apart = (along(0) - of_middle < -strictly) & (along(10) - of_middle < -strictly) &
                         (along(1) - of_middle > strictly) & (along(9) - of_middle > strictly);
  return (bits_of(apart) & 7) == 7;
}

template <std::size_t kVertices>
VDWMESH_INLINE bool PatchOutline::keeps_out(const PatchOutline& other) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes x = all_lanes(normal_[0][k]), y = all_lanes(normal_[1][k]),
                z = all_lanes(normal_[2][k]), limit = all_lanes(limit_[k]);
    const auto within = [&](std::size_t lane) {
      const Lanes side = x * lanes_at(&other.position_[0][lane]) +
                         y * lanes_at(&other.position_[1][lane]) +
                         z * lanes_at(&other.position_[2][lane]);
      return side >= limit;
    };
    std::uint32_t left = kVertices == 6 ? bits_of(within(0), within(8)) : bits_of(within(0));
    // The vertices that are not strictly outside must be those of the edge.
    for (; left != 0; left &= left - 1) {
      const std::uint32_t v = other.vertex_[static_cast<std::size_t>(std::countr_zero(left))];
      if (v != vertex_[k] && v != vertex_[k + 1] && (kVertices == 3 || v != vertex_[4 + k])) break;
    }
    if (left == 0) return true;
  }
  return false;
}

}  // namespace vdwmesh
