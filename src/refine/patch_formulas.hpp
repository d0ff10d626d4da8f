// Midpoints of a mesh whose triangles know their patches, for host and device. The midpoint of an
// edge inside a patch goes to the sphere or torus of the patch, to its point nearest to the middle
// of the edge. The midpoint of an edge between two patches goes to the middle of the arc of the
// circle in which they meet; all pairs of patches that meet have a formula for it without an
// intersection:
//
//   contact, saddle    a circle about the axis of the saddle
//   saddle, concave    a great circle of the probe's sphere, in a plane with the axis of the saddle
//   concave, concave   a circle about the line through both probes
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/constraint_formulas.hpp"
#include "refine/sphere_formulas.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

// The point nearest to p on the torus of a saddle, or on that half of its profile circles that p
// itself is on. Not found if p lies on the axis, or on the circle of the probe's centres.
VDWMESH_HD inline FoundPoint nearest_on_torus(const SurfacePatch& saddle, const Vec3d& p) {
  const Vec3d from_center = p - saddle.center;
  const Vec3d radial = along(from_center, -dot(from_center, saddle.axis), saddle.axis);
  const double girth = norm(radial);
  if (!(girth > 0)) return {p, false};
  const Vec3d probe = along(saddle.center, saddle.ring_radius / girth, radial);
  return nearest_on_sphere({probe, saddle.radius}, p);
}

VDWMESH_HD inline FoundPoint nearest_on_patch(const SurfacePatch& patch, const Vec3d& p) {
  return patch.kind == PatchKind::saddle ? nearest_on_torus(patch, p)
                                         : nearest_on_sphere({patch.center, patch.radius}, p);
}

// The middle of the shorter arc from u to v on the circle in which two different patches meet. Not
// found for kinds of patches that never meet in a curve.
VDWMESH_HD inline FoundPoint curve_midpoint(const SurfacePatch& a, const SurfacePatch& b,
                                            const Vec3d& u, const Vec3d& v) {
  const bool in_order = a.kind <= b.kind;
  const SurfacePatch &first = in_order ? a : b, &second = in_order ? b : a;
  if (first.kind == PatchKind::contact && second.kind == PatchKind::saddle) {
    return arc_midpoint_about(second.center, second.axis, u, v);
  }
  if (first.kind == PatchKind::contact || second.kind != PatchKind::concave) return {u, false};
  const Sphere one{first.center, first.radius}, other{second.center, second.radius};
  if (first.kind == PatchKind::saddle) return nearest_on_sphere(other, midpoint(u, v));
  return precedes(other, one) ? arc_midpoint(other, one, u, v) : arc_midpoint(one, other, u, v);
}

// The distance (Å) of p from the sphere or torus of a patch.
VDWMESH_HD inline double patch_residual(const SurfacePatch& patch, const Vec3d& p) {
  const PatchFooting f = footing(patch, p);
  // On the axis of a saddle all probes of its circle are equally far.
  const double height = dot(p - patch.center, patch.axis);
  const double distance = f.girth > 0
                              ? norm(f.to_center)
                              : std::sqrt(height * height + patch.ring_radius * patch.ring_radius);
  return std::abs(distance - patch.radius);
}

}  // namespace vdwmesh
