// Whether a plane keeps two patches apart, so that none of their triangles can cross.
//
// The walls of a patch are planes through its edges. The wall of a divided edge goes through the
// edge's ends u and v and its midpoint m; that of an edge without a midpoint, which is that of a
// single triangle, goes through u and v at right angles to the triangle. A wall is of use if all
// other vertices of its patch lie strictly on one side of it. Then another patch is apart if all of
// its vertices lie strictly on the other side, but for those that are u, v or m themselves.
//
// Why no triangle s of the one then crosses a triangle t of the other: s lies in the closed half of
// space on the one side and t in that on the other, so both meet at most in the wall. There, s has
// no more than one of the edges u m and m v (or u v), or one of their ends, and so has t. The three
// points are not in one line (a wall would not be of use), so two different edges have only m in
// common. What the triangles share is thus an edge or a vertex of both, or nothing. The argument is
// about the triangles as they are now: it holds on every level, in every pass, for any labels.
//
// Sides are computed in double. Let all coordinates be at most w from the origin, ε = 2^-53, e = v
// - u, and d the vector from the middle of u and v to m, or the normal of the triangle. Coordinates
// lose εw when they are taken from the origin, and e and d in each coordinate up to 4εw (the normal
// is taken as it is). The normal of the wall n = e × d then loses up to 20 ε w (|e| + |d|), and the
// side n · (x - u), |x - u| < 4w, less than 2^9 ε w² (|e| + |d|), with sums of magnitudes for
// lengths. Strictly on a side means by 2^13 ε of w² (|e| + |d|).
//
// The children of a divided triangle share vertices, too: all an edge with the middle one, and two
// at a corner each a midpoint. The plane through that midpoint and the corner that neither of them
// has, at right angles to the corners' triangle, keeps these two apart if it does so strictly with
// their other vertices. Any plane through the midpoint will do, so only sides are rounded.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/lane_masks.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

class PatchOutline {
 public:
  // Takes a patch of three vertices, or of six: the corners, then the midpoint of the edge from
  // corner k to the next one for k = 0, 1, 2. Positions (Å) are from an origin near the
  // patches that are compared; no coordinate is larger than `reach`.
  template <std::size_t kVertices>
  void set(const std::array<std::uint32_t, kVertices>& vertex,
           const std::array<Vec3d, kVertices>& position, double reach);

  // Whether planes keep the three corner children of the patch, which has six vertices, apart.
  bool separates_children(double reach) const;

  // Whether a wall of this patch keeps the other one apart, which has as many vertices.
  template <std::size_t kVertices>
  bool shuts_out(const PatchOutline& other) const;

 private:
  static constexpr double kStrictly = 0x1p-40;
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  // By axis, corners 0, 1, 2, 0, 1 and from lane 8 on the midpoints in the same order: so four in a
  // row are corners, or midpoints, from any one on. The lanes 0 to 3 and 8 to 11 are all vertices.
  alignas(32) double place_[3][16] = {};
  std::array<std::uint32_t, 8> vertex_;  // of these eight lanes
  // By edge: the normal of the wall, towards the patch, and what n · x is less than for every x
  // that is strictly on the other side. Minus infinity for a wall of no use.
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
      for (int axis = 0; axis < 3; ++axis) place_[axis][lane + k] = position[v][axis];
      if (k < 4) vertex_[bit + k] = vertex[v];
    }
  }
  Lanes edge[3], up[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes u = lanes_at(&place_[axis][0]), v = lanes_at(&place_[axis][1]);
    edge[axis] = v - u;
    if constexpr (kVertices == 6) up[axis] = lanes_at(&place_[axis][8]) - 0.5 * (u + v);
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
  // The sides of the vertices that are not of the edge: the third corner and both other midpoints.
  const auto along = [&](std::size_t lane) {
    return normal[0] * lanes_at(&place_[0][lane]) + normal[1] * lanes_at(&place_[1][lane]) +
           normal[2] * lanes_at(&place_[2][lane]);
  };
  const Lanes of_edge = along(0), third = along(2) - of_edge;
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
  const LaneBits is_of_use = (least > strictly) | (most < -strictly);
  for (int axis = 0; axis < 3; ++axis) store_lanes(normal_[axis], sign * normal[axis]);
  store_lanes(limit_, is_of_use ? sign * of_edge - strictly : all_lanes(-kInfinity));
}

VDWMESH_INLINE bool PatchOutline::separates_children(double reach) const {
  Lanes across[3], up[3], to_third[3], plane[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double *const corner = place_[axis], *const middle = corner + 8;
    across[axis] = all_lanes(corner[1] - corner[0]);
    up[axis] = all_lanes(corner[2] - corner[0]);
    to_third[axis] = lanes_at(corner + 2) - lanes_at(middle);
  }
  Lanes normal[3];
  cross_lanes(across, up, normal);
  cross_lanes(to_third, normal, plane);
  Lanes size = all_lanes(0);
  const auto along = [&](std::size_t lane) {
    return plane[0] * lanes_at(&place_[0][lane]) + plane[1] * lanes_at(&place_[1][lane]) +
           plane[2] * lanes_at(&place_[2][lane]);
  };
  for (int axis = 0; axis < 3; ++axis) size += magnitude_of(plane[axis]);
  const Lanes strictly = kStrictly * reach * size, of_middle = along(8);
  const LaneBits apart = (along(0) - of_middle < -strictly) & (along(10) - of_middle < -strictly) &
                         (along(1) - of_middle > strictly) & (along(9) - of_middle > strictly);
  return (bits_of(apart) & 7) == 7;
}

template <std::size_t kVertices>
VDWMESH_INLINE bool PatchOutline::shuts_out(const PatchOutline& other) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes x = all_lanes(normal_[0][k]), y = all_lanes(normal_[1][k]),
                z = all_lanes(normal_[2][k]), limit = all_lanes(limit_[k]);
    const auto within = [&](std::size_t lane) {
      const Lanes side = x * lanes_at(&other.place_[0][lane]) +
                         y * lanes_at(&other.place_[1][lane]) +
                         z * lanes_at(&other.place_[2][lane]);
      return side >= limit;
    };
    std::uint32_t left = kVertices == 6 ? bits_of(within(0), within(8)) : bits_of(within(0));
    // What is left must be vertices of the edge.
    for (; left != 0; left &= left - 1) {
      const std::uint32_t v = other.vertex_[static_cast<std::size_t>(std::countr_zero(left))];
      if (v != vertex_[k] && v != vertex_[k + 1] && (kVertices == 3 || v != vertex_[4 + k])) break;
    }
    if (left == 0) return true;
  }
  return false;
}

}  // namespace vdwmesh
