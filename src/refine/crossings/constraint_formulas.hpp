// Midpoints of a mesh whose triangles are labelled with their spheres, for host and device. A
// crease is a circle in which two spheres meet. Such a mesh has edges along every crease, and the
// midpoints must lie on the creases too. patch_formulas.hpp has the same for patches of all kinds.
//
// The midpoint of an edge between two triangles of one sphere goes to that sphere. The midpoint of
// an edge between triangles of two spheres goes to the circle in which the spheres meet. All
// thresholds are ratios of lengths, so the result scales with the input, however small a circle is.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/sphere_formulas.hpp"
#include "refine/subdivision_formulas.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The spheres that the midpoint of an edge between triangles of spheres a and b must lie on: one
// sphere, or two with the lower id first. Unused entries are kNoSphere.
VDWMESH_HD inline VertexSpheres edge_label(SphereId a, SphereId b) {
  if (a == b) return {a, kNoSphere, kNoSphere};
  if (a < b) return {a, b, kNoSphere};
  return {b, a, kNoSphere};
}

// Two points of a circle count as opposite if the mean of their radial vectors is shorter than this
// fraction of the radius. The mean is then hardly more than rounding (2^-53 = 1e-16 of the
// coordinates), so its direction does not say which arc between the points is the shorter one.
inline constexpr double kOppositeEnds = 1e-12;

// The middle of the shorter arc from u to v on a circle about an axis, which is a line through
// `origin` along `axis`, a vector of any length. This is also the point of the circle nearest to
// the middle of u and v. Not found if the axis has no length, or if u and v are opposite points of
// the circle.
//
// Each end is split into its height along the axis and its radial vector. The result has the mean
// height, the direction of the mean radial vector, and the root mean square of the two radial
// lengths. The radius is taken from the ends and not from the spheres that meet in the circle:
// sqrt(r^2 - h^2) loses all digits if the circle is tiny, while the ends are as near to both
// spheres as their coordinates allow. See docs/refinement.md, "Meshes that follow the creases".
VDWMESH_HD inline FoundPoint arc_midpoint_about(const Vec3d& origin, const Vec3d& axis,
                                                const Vec3d& u, const Vec3d& v) {
  const double square = squared_norm(axis);
  if (!(square > 0)) return {u, false};
  const Vec3d from_u = u - origin, from_v = v - origin;
  // Heights above the origin, as fractions of the axis vector.
  const double height_u = dot(from_u, axis) / square, height_v = dot(from_v, axis) / square;
  const Vec3d radial_u = along(from_u, -height_u, axis), radial_v = along(from_v, -height_v, axis);
  const Vec3d radial = midpoint(radial_u, radial_v);
  const double radius_square = 0.5 * (squared_norm(radial_u) + squared_norm(radial_v));
  const double length_square = squared_norm(radial);
  if (!(length_square > kOppositeEnds * kOppositeEnds * radius_square)) return {u, false};
  const Vec3d middle = along(origin, 0.5 * (height_u + height_v), axis);
  return {along(middle, std::sqrt(radius_square / length_square), radial), true};
}

// The same on the circle in which spheres a and b meet. Not found if they are concentric.
VDWMESH_HD inline FoundPoint arc_midpoint(const Sphere& a, const Sphere& b, const Vec3d& u,
                                          const Vec3d& v) {
  return arc_midpoint_about(a.center, b.center - a.center, u, v);
}

// The position of the midpoint of edge u v, given its label. Falls back to the middle of the edge
// if the sphere or circle has no unique nearest point. The result has the same bits if u and v are
// swapped, and if the spheres have other ids: canonical order decides which sphere comes first.
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

// The largest distance (Å) of p from the spheres of its label; 0 if the label is empty.
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

// union_normal() with the label's spheres sorted into canonical order. The sum of their normals
// then rounds alike whatever the ids of the spheres. The sort is an insertion sort.
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
