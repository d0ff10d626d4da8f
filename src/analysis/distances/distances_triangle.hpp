// Squared distance from a point to a segment and to a triangle, for host and device.
//
// These functions are the inner loop of the distance search. Coordinates are in Å, results in Å².
#pragma once

#include "analysis/distances/triangle_points.hpp"
#include "core/host_device.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// A dot product without fma, unlike dot() of vec3.hpp. This code is compiled for every x86-64
// processor, and there std::fma is a library call.
VDWMESH_HD inline double plain_dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VDWMESH_HD inline double squared(const Vec3d& a) { return plain_dot(a, a); }

VDWMESH_HD inline double squared_distance_to_segment(const Vec3d& p, const Vec3d& a,
                                                     const Vec3d& b) {
  const Vec3d ab = b - a, ap = p - a;
  const double length = squared(ab);
  // The parameter of the nearest point of the line, clamped to the segment. A segment of no length
  // is the point a.
  double t = length > 0 ? plain_dot(ap, ab) / length : 0.0;
  t = t > 0 ? (t < 1 ? t : 1.0) : 0.0;
  return squared(ap - t * ab);
}

// If the squared sine of the angle at corner a is at most this, the triangle is measured as its
// three edges. Its width is then at most 1e-7 of an edge, and its normal, a difference of nearly
// equal products, has few correct digits. A triangle with an edge of no length counts as flat too.
inline constexpr double kFlatTriangle = 1e-14;

// Returns the squared distance from p to the triangle abc, which may be degenerate to a segment or
// a point. The code finds the feature (corner, edge or face) whose Voronoi region contains p (C.
// Ericson, Real-Time Collision Detection (2005), section 5.1.5). d1, d3 and d5 are the dot products
// of ab with ap, bp and cp; d2, d4 and d6 are those of ac. va, vb and vc are barycentric
// coordinates of p without normalisation: each is at most 0 if p is beyond the edge opposite to its
// corner. `area` is the squared length of the normal, thus four times the squared area (Å⁴). The
// tests of the three corners come first; they are valid for flat triangles too.
VDWMESH_HD inline double squared_distance_to_triangle(const Vec3d& p, const Vec3d& a,
                                                      const Vec3d& b, const Vec3d& c) {
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = plain_dot(ab, ap), d2 = plain_dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return squared(ap);
  const Vec3d bp = p - b;
  const double d3 = plain_dot(ab, bp), d4 = plain_dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return squared(bp);
  const Vec3d cp = p - c;
  const double d5 = plain_dot(ab, cp), d6 = plain_dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return squared(cp);
  const Vec3d normal = cross(ab, ac);
  const double area = squared(normal);
  const bool flat = !(area > kFlatTriangle * squared(ab) * squared(ac));
  if (flat) {
    double least = squared_distance_to_segment(p, a, b);
    const double bc = squared_distance_to_segment(p, b, c);
    const double ca = squared_distance_to_segment(p, c, a);
    least = bc < least ? bc : least;
    return ca < least ? ca : least;
  }
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(ap - (d1 / (d1 - d3)) * ab);
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(ap - (d2 / (d2 - d6)) * ac);
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return squared(bp - ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  }
  // p is above or below the face: its distance from the plane is |normal · ap| / |normal|.
  const double height = plain_dot(normal, ap);
  return height * height / area;
}
VDWMESH_HD inline double squared_distance_to(const Vec3d& p, const Corners& t) {
  return squared_distance_to_triangle(p, t.a, t.b, t.c);
}

}  // namespace vdwmesh
