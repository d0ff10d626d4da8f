// Whether two triangles of a mesh pass through each other, for host and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// Six times the volume of the tetrahedron (a, b, c, d), positive where d sees a b c clockwise.
VDWMESH_HD inline double orientation(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                     const Vec3d& d) {
  return dot(cross(b - a, c - a), d - a);
}

// Whether the segment p q passes through the triangle t, its edges included. Segments that only
// touch the triangle's plane do not: neighbours in one plane are no crossing.
VDWMESH_HD inline int pierces(const Vec3d& p, const Vec3d& q, const Vec3d* t) {
  const double side_p = orientation(t[0], t[1], t[2], p);
  const double side_q = orientation(t[0], t[1], t[2], q);
  if (!((side_p < 0 && side_q > 0) || (side_p > 0 && side_q < 0))) return 0;
  const double a = orientation(p, q, t[0], t[1]);
  const double b = orientation(p, q, t[1], t[2]);
  const double c = orientation(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

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

// Whether triangles s and t, with vertices vs and vt, pass through each other: some edge of one
// pierces the other. Edges that end in a shared vertex cannot, and neighbours across an edge are
// left to the orientation tests.
VDWMESH_HD inline int triangles_cross(const Vec3d* s, const std::uint32_t* vs, const Vec3d* t,
                                      const std::uint32_t* vt) {
  if (!boxes_overlap(s, t)) return 0;
  int shared_s = 0, shared_t = 0;  // bit k: corner k is a vertex of the other triangle
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (vs[i] != vt[j]) continue;
      shared_s |= 1 << i;
      shared_t |= 1 << j;
    }
  }
  if ((shared_s & (shared_s - 1)) != 0) return 0;
  for (int k = 0; k < 3; ++k) {
    const int next = k == 2 ? 0 : k + 1;
    const int ends = (1 << k) | (1 << next);
    if ((shared_s & ends) == 0 && pierces(s[k], s[next], t)) return 1;
    if ((shared_t & ends) == 0 && pierces(t[k], t[next], s)) return 1;
  }
  return 0;
}

}  // namespace vdwmesh
