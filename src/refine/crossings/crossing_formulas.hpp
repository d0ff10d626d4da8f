// Whether two triangles of a mesh pass through each other, for host and device.
//
// Two triangles cross if an edge of one pierces the other: if its ends lie on different sides of
// the other's plane, and its line meets the other triangle. Both are asked by signs of
// determinants, the signed volumes of tetrahedra. A side counts only if it is certain, that is,
// larger than its rounding error, so triangles that touch do not cross by rounding. The line is
// judged exactly: by a volume that is certain, or by the sign of the same volume without rounding
// (exact_volume.hpp). So triangles that cross here have a point in common that is no vertex of
// both, in exact arithmetic.
//
// Host and device get the same signs: both round every single operation in the same way, because
// the build forbids fused multiply-adds (-ffp-contract=off, --fmad=false) but those that are
// written out. All tests below answer 0 or 1 as an int.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/exact_volume.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A determinant of three vectors as it was computed, and a bound of its rounding error.
struct SignedVolume {
  double value, error;
};

// 1 or -1 if the sign is certain, else 0.
VDWMESH_HD inline int certain_sign(const SignedVolume& v) {
  return v.value > v.error ? 1 : (v.value < -v.error ? -1 : 0);
}

VDWMESH_HD inline Vec3d magnitudes(const Vec3d& a) {
  using std::abs;
  return {abs(a.x), abs(a.y), abs(a.z)};
}

// Two vectors u and v, ready for determinants (u, v, w): their cross product, and the same with all
// magnitudes and all signs positive.
struct SpannedPlane {
  Vec3d normal, magnitude;
};

VDWMESH_HD inline SpannedPlane span_plane(const Vec3d& u, const Vec3d& v) {
  const Vec3d a = magnitudes(u), b = magnitudes(v);
  return {cross(u, v), {a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x}};
}

// The determinant (u, v, w) of vectors that are rounded differences of points; the bound holds for
// the exact differences. Each of the six products of the determinant has three factors with an
// error of ε = 2^-53 each, is rounded twice and goes through three sums at most: 8 ε of its
// magnitude, to first order. 16 ε covers the rest, and the rounding of the bound itself.
VDWMESH_HD inline SignedVolume signed_volume(const SpannedPlane& plane, const Vec3d& w) {
  constexpr double kRounding = 0x1p-49, kUnderflow = 0x1p-1000;
  return {dot(plane.normal, w), kRounding * dot(plane.magnitude, magnitudes(w)) + kUnderflow};
}

// The sign of the volume of the tetrahedron (a, b, c, d). Positive if a, b, c run counter-clockwise
// as seen from d.
VDWMESH_HD inline int orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const int sign = certain_sign(signed_volume(span_plane(b - a, c - a), d - a));
  return sign != 0 ? sign : exact_orientation(a, b, c, d);
}

// Whether the straight line through p and q meets triangle t, the edges of t included.
// Precondition: p and q lie on different sides of the plane of t. The line then crosses the plane
// between p and q, so the answer is the same for the segment p q. The line meets t if and only if
// no two of the three volumes have opposite signs: then it passes all edges of t on the same side,
// or meets the line of an edge (volume 0).
VDWMESH_HD inline int line_meets(const Vec3d& p, const Vec3d& q, const Vec3d* t) {
  const int a = orientation(p, q, t[0], t[1]);
  const int b = orientation(p, q, t[1], t[2]);
  if (a * b < 0) return 0;
  const int c = orientation(p, q, t[2], t[0]);
  return a * c >= 0 && b * c >= 0;
}

// Whether an edge of s pierces t. Bit k of `shared` says that corner k of s is a vertex of t too.
// An edge that ends in such a corner touches t there and is left out. Of the others, an edge counts
// only if its ends lie on different sides of the plane of t for certain. So triangles that touch
// with a corner or lie in one plane do not cross, but two edges that meet within both do.
VDWMESH_HD inline int edge_pierces(const Vec3d* s, int shared, const Vec3d* t) {
  const SpannedPlane plane = span_plane(t[1] - t[0], t[2] - t[0]);
  int side[3];
  for (int k = 0; k < 3; ++k) side[k] = certain_sign(signed_volume(plane, s[k] - t[0]));
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    if ((shared & ((1 << k) | (1 << next))) != 0) continue;
    if (side[k] * side[next] < 0 && line_meets(s[k], s[next], t)) return 1;
  }
  return 0;
}

// Whether the axis-parallel bounding boxes of two triangles have a point in common.
VDWMESH_HD inline int boxes_overlap(const Vec3d* s, const Vec3d* t) {
  for (int axis = 0; axis < 3; ++axis) {
    double low[2], high[2];
    const Vec3d* corners[2] = {s, t};
    for (int i = 0; i < 2; ++i) {
      const double a = corners[i][0][axis], b = corners[i][1][axis], c = corners[i][2][axis];
      low[i] = a < b ? (a < c ? a : c) : (b < c ? b : c);
      high[i] = a > b ? (a > c ? a : c) : (b > c ? b : c);
    }
    if (low[0] > high[1] || low[1] > high[0]) return 0;
  }
  return 1;
}

// Whether triangles s and t cross: whether an edge of one pierces the other. `vs` and `vt` are the
// vertex indices of the triangles' corners, `atoms_s` and `atoms_t` the atoms of these vertices.
//
// Two kinds of neighbours never count as crossing. Triangles that share an edge meet nowhere else,
// unless one is folded into the plane of the other. Triangles that share one vertex are left out if
// all their corners have the same atom (kNoSphere is none): on one sphere they can cross only if
// one of them faces against the outward normal, and BadMoves takes that one back because of
// facing() (subdivision_formulas.hpp).
//
// Precondition: boxes_overlap(s, t). For a pair with boxes apart, rounding could give any signs. A
// search that happens to test such a pair would report a crossing, and another search would not.
// The precondition keeps the answer independent of the search.
VDWMESH_HD inline int triangles_cross(const Vec3d* s, const std::uint32_t* vs,
                                      const SphereId* atoms_s, const Vec3d* t,
                                      const std::uint32_t* vt, const SphereId* atoms_t) {
  int shared_s = 0, shared_t = 0;  // bit k: corner k is a vertex of the other triangle
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (vs[i] != vt[j]) continue;
      shared_s |= 1 << i;
      shared_t |= 1 << j;
    }
  }
  // x & (x - 1) clears the lowest bit of x. If bits are left there were two, so an edge is shared.
  if ((shared_s & (shared_s - 1)) != 0) return 0;
  const bool one_atom = atoms_s[0] == atoms_s[1] && atoms_s[0] == atoms_s[2] &&
                        atoms_s[0] == atoms_t[0] && atoms_s[0] == atoms_t[1] &&
                        atoms_s[0] == atoms_t[2] && atoms_s[0] != kNoSphere;
  if (shared_s != 0 && one_atom) return 0;
  return edge_pierces(s, shared_s, t) || edge_pierces(t, shared_t, s);
}

}  // namespace vdwmesh
