// Whether two triangles of a mesh pass through each other, for host and device.
//
// Two triangles cross if an edge of one pierces the other. Each of the six edges is tested by the
// signs of tetrahedron volumes, the classical orientation test. The signs are computed in double
// without an exact fallback, so they can be wrong if a volume is near zero. Host and device still
// get the same signs: both round every single operation in the same way, because the build forbids
// fused multiply-adds (-ffp-contract=off, --fmad=false). All tests below answer 0 or 1 as an int.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Six times the signed volume of the tetrahedron (a, b, c, d). Positive if a, b, c run
// counter-clockwise as seen from d.
VDWMESH_HD inline double orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                     const Vec3d& d) {
  return dot(cross(b - a, c - a), d - a);
}

// Whether the straight line through p and q meets triangle t, the edges of t included.
// Precondition: p and q lie on different sides of the plane of t. The line then crosses the plane
// between p and q, so the answer is the same for the segment p q. The line meets t if and only if
// no two of the three volumes have opposite signs: then it passes all edges of t on the same side,
// or meets the line of an edge (volume 0).
VDWMESH_HD inline int line_meets(const Vec3d& p, const Vec3d& q, const Vec3d* t) {
  const double a = orientation(p, q, t[0], t[1]);
  const double b = orientation(p, q, t[1], t[2]);
  const double c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// Whether an edge of s pierces t. Bit k of `shared` says that corner k of s is a vertex of t too.
// An edge that ends in such a corner touches t there and is left out. Of the others, an edge counts
// only if its ends lie strictly on different sides of the plane of t. So triangles that touch with
// a corner or lie in one plane do not cross, but two edges that meet within both do.
VDWMESH_HD inline int edge_pierces(const Vec3d* s, int shared, const Vec3d* t) {
  const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
  double side[3];
  for (int k = 0; k < 3; ++k) side[k] = dot(normal, s[k] - t[0]);
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    if ((shared & ((1 << k) | (1 << next))) != 0) continue;
    const bool apart = (side[k] < 0 && side[next] > 0) || (side[k] > 0 && side[next] < 0);
    if (apart && line_meets(s[k], s[next], t)) return 1;
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
