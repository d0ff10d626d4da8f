// Whether two triangles of a mesh pass through each other, for host and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Six times the volume of the tetrahedron (a, b, c, d), positive where d sees a b c clockwise.
VDWMESH_HD inline double orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                     const Vec3d& d) {
  return dot(cross(b - a, c - a), d - a);
}

// Whether the line p q, whose ends lie on either side of the plane of triangle t, meets t, its
// edges included.
VDWMESH_HD inline int line_meets(const Vec3d& p, const Vec3d& q, const Vec3d* t) {
  const double a = orientation(p, q, t[0], t[1]);
  const double b = orientation(p, q, t[1], t[2]);
  const double c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// Whether an edge of s pierces t. Edges that end in a vertex of t (bits of `shared`) cannot; those
// that only touch the plane of t do not: neighbours in one plane are no crossing.
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

// Whether the boxes of two triangles have a point in common.
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

// Whether triangles s and t, of vertices vs and vt and atoms as and at, pass through each other:
// some edge of one pierces the other. Edges that end in a shared vertex cannot; neighbours across
// an edge are left to the orientation tests, and so are neighbours around a vertex that are both of
// the same single atom. Precondition: boxes_overlap(s, t), which is part of the definition.
VDWMESH_HD inline int triangles_cross(const Vec3d* s, const std::uint32_t* vs, const SphereId* as,
                                      const Vec3d* t, const std::uint32_t* vt, const SphereId* at) {
  int shared_s = 0, shared_t = 0;  // bit k: corner k is a vertex of the other triangle
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (vs[i] != vt[j]) continue;
      shared_s |= 1 << i;
      shared_t |= 1 << j;
    }
  }
  if ((shared_s & (shared_s - 1)) != 0) return 0;
  const bool one_atom = as[0] == as[1] && as[0] == as[2] && as[0] == at[0] && as[0] == at[1] &&
                        as[0] == at[2] && as[0] != kNoSphere;
  if (shared_s != 0 && one_atom) return 0;
  return edge_pierces(s, shared_s, t) || edge_pierces(t, shared_t, s);
}

}  // namespace vdwmesh
