// Where the midpoints of a mesh whose triangles name their spheres go, for host and device.
//
// An edge between two triangles of one sphere has its midpoint on that sphere, an edge between
// triangles of two spheres on their circle. No threshold has a length in it: nothing changes when
// all is scaled, however small a circle is.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/sphere_formulas.hpp"
#include "refine/subdivision_formulas.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The label of an edge between triangles of spheres a and b: one sphere, or two, lower id first.
VDWMESH_HD inline VertexSpheres edge_label(SphereId a, SphereId b) {
  if (a == b) return {a, kNoSphere, kNoSphere};
  if (a < b) return {a, b, kNoSphere};
  return {b, a, kNoSphere};
}

// Of the mean of two radial directions, relative to them: below it the ends are opposite points of
// the circle to rounding, and either half could be meant.
inline constexpr double kOppositeEnds = 1e-12;

// The middle of the shorter arc from u to v on the circle of spheres a and b, which is the point of
// the circle nearest to the middle of u and v: the ends, turned half-way about the line of the
// centres. Its radius is theirs, so that it is as near to the spheres as they are, also where the
// circle is too small for its radius to be told from those of the spheres. Not found for concentric
// spheres and for opposite ends.
VDWMESH_HD inline FoundPoint arc_midpoint(const Sphere& a, const Sphere& b, const Vec3d& u,
                                          const Vec3d& v) {
  const Vec3d axis = b.center - a.center;
  const double square = squared_norm(axis);
  if (!(square > 0)) return {u, false};
  const Vec3d from_u = u - a.center, from_v = v - a.center;
  const double height_u = dot(from_u, axis) / square, height_v = dot(from_v, axis) / square;
  const Vec3d radial_u = along(from_u, -height_u, axis), radial_v = along(from_v, -height_v, axis);
  const Vec3d radial = midpoint(radial_u, radial_v);
  const double radius_square = 0.5 * (squared_norm(radial_u) + squared_norm(radial_v));
  const double length_square = squared_norm(radial);
  if (!(length_square > kOppositeEnds * kOppositeEnds * radius_square)) return {u, false};
  const Vec3d middle = along(a.center, 0.5 * (height_u + height_v), axis);
  return {along(middle, std::sqrt(radius_square / length_square), radial), true};
}

// Where the midpoint of the edge u v goes; the plain one where there is no such point. The same
// bits from either end, and whatever the ids of the spheres.
VDWMESH_HD inline Vec3d constrained_midpoint(const Sphere* spheres, const SphereId* label,
                                             const Vec3d& u, const Vec3d& v) {
  const Sphere& a = spheres[label[0]];
  FoundPoint found{u, false};
  if (label[1] == kNoSphere) {
    found = nearest_on_sphere(a, midpoint(u, v));
  } else {
    const Sphere& b = spheres[label[1]];
    found = precedes(b, a) ? arc_midpoint(b, a, u, v) : arc_midpoint(a, b, u, v);
  }
  return found.found ? found.position : midpoint(u, v);
}

// Distance from p to the farthest of the spheres of its label, Å.
VDWMESH_HD inline double label_residual(const Sphere* spheres, const SphereId* label,
                                        const Vec3d& p) {
  using std::abs;
  double most = 0;
  for (int i = 0; i < 3 && label[i] != kNoSphere; ++i) {
    const double off = abs(gap(spheres[label[i]], p));
    if (off > most) most = off;
  }
  return most;
}

// union_normal(), with the spheres in canonical order: the same bits whatever their ids.
VDWMESH_HD inline Vec3f constrained_normal(const Sphere* spheres, const SphereId* label,
                                           const Vec3d& p) {
  SphereId sorted[3] = {label[0], label[1], label[2]};
  for (int i = 1; i < 3 && sorted[i] != kNoSphere; ++i) {
    for (int j = i; j > 0 && precedes(spheres[sorted[j]], spheres[sorted[j - 1]]); --j) {
      const SphereId later = sorted[j - 1];
      sorted[j - 1] = sorted[j];
      sorted[j] = later;
    }
  }
  return union_normal(spheres, sorted, p);
}

}  // namespace vdwmesh
