// Midpoints of a mesh whose triangles know their patches, for host and device: on the sphere or
// torus of one patch, or on the circle in which two patches meet. All pairs of patches that meet
// have a formula for their circle without an intersection:
//
//   contact, saddle    a circle about the axis of the saddle
//   saddle, concave    the profile circle of the saddle, a great circle of the probe's sphere
//   concave, concave   a circle about the line through both probes
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "refine/crossings/constraint_formulas.hpp"
#include "refine/sphere_formulas.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

// A point of a saddle in the coordinates of its torus: the radial unit vector, the distance from
// the axis, and cosine and sine of half of the profile angle α.
struct SaddlePoint {
  Vec3d radial;  // zero on the axis
  double girth;
  double half_cosine, half_sine;
};

VDWMESH_HD inline SaddlePoint saddle_point(const SurfacePatch& saddle, const Vec3d& p) {
  const Vec3d from_center = p - saddle.center;
  const double height = dot(from_center, saddle.axis);
  const Vec3d radial = along(from_center, -height, saddle.axis);
  const double girth = norm(radial);
  // With the probe's radius p, the vector (p + p cos α, p sin α) has the angle α/2. The second
  // component is the height, and p cos α the distance of the point from the circle of centres
  // towards the axis. α is within ±90°.
  const double x = saddle.radius + (saddle.ring_radius - girth);
  const double length = std::sqrt(x * x + height * height);
  return {girth > 0 ? (1 / girth) * radial : Vec3d{0, 0, 0}, girth, x / length, height / length};
}

// The point nearest to p on the torus of a saddle. Not found if p lies on the axis, or on the
// circle of the probe's centres.
VDWMESH_HD inline FoundPoint nearest_on_torus(const SurfacePatch& saddle, const Vec3d& p) {
  const Vec3d from_center = p - saddle.center;
  const Vec3d radial = along(from_center, -dot(from_center, saddle.axis), saddle.axis);
  const double girth = norm(radial);
  if (!(girth > 0)) return {p, false};
  const Vec3d probe = along(saddle.center, saddle.ring_radius / girth, radial);
  return nearest_on_sphere({probe, saddle.radius}, p);
}

// The midpoint of the image of an edge in the conformal chart of a saddle, for a circle of the
// probe's centres that is larger than the probe. The chart is a rectangle (φ, s) with ds = p dα / g
// for the girth g = ρ - p cos α (excluded/mesher/saddle_chart.hpp). Its triangles are divided as in
// the plane, so none of them folds, however thin the waist of the saddle is. The point of the torus
// nearest to the middle of u and v would not do: its φ is nearly that of the end with the larger
// girth.
//
// φ of the midpoint is the mean of the two, the direction of the sum of the radial unit vectors.
// With t = tan(α/2) and D = (ρ - p) / (ρ + p), s is a multiple of atan(t / √D), the angle of the
// vector (√D, t). Its mean is the angle of the sum of the unit vectors (√D, tᵢ) / nᵢ, with
// nᵢ² = D + tᵢ² = gᵢ / ((ρ + p) cos²(αᵢ/2)). So for the midpoint
//
//   tan(α/2) = (Σ tᵢ / nᵢ) / (Σ 1 / nᵢ) = (Σ sin(αᵢ/2) / √gᵢ) / (Σ cos(αᵢ/2) / √gᵢ),
//
// the direction of the sum of the vectors (cos(αᵢ/2), sin(αᵢ/2)) with the weights 1 / √gᵢ.
//
// Not found if the ends are opposite of each other about the axis.
VDWMESH_HD inline FoundPoint chart_midpoint(const SurfacePatch& saddle, const SaddlePoint& a,
                                            const SaddlePoint& b) {
  const Vec3d turn = a.radial + b.radial;
  const double length = norm(turn);
  if (!(length > kOppositeEnds)) return {turn, false};
  const double weight_a = 1 / std::sqrt(a.girth), weight_b = 1 / std::sqrt(b.girth);
  const double c = weight_a * a.half_cosine + weight_b * b.half_cosine;
  const double s = weight_a * a.half_sine + weight_b * b.half_sine;
  const double square = c * c + s * s;
  const double cosine = (c - s) * (c + s) / square, sine = 2 * (c * s) / square;
  const Vec3d foot = along(saddle.center, saddle.radius * sine, saddle.axis);
  return {along(foot, (saddle.ring_radius - saddle.radius * cosine) / length, turn), true};
}

// The midpoint of an edge of a saddle, inside of it or on a profile circle. Where the torus reaches
// its axis (a circle of centres smaller than the probe), saddles end in cusps or before, and the
// chart is a sector about the cusp, in which distances are nearly those in space: the nearest point
// to the middle of the ends serves.
VDWMESH_HD inline FoundPoint saddle_midpoint(const SurfacePatch& saddle, const Vec3d& u,
                                             const Vec3d& v) {
  if (saddle.ring_radius > saddle.radius) {
    const SaddlePoint a = saddle_point(saddle, u), b = saddle_point(saddle, v);
    if (a.girth > 0 && b.girth > 0) return chart_midpoint(saddle, a, b);
  }
  return nearest_on_torus(saddle, midpoint(u, v));
}

// The midpoint of an edge inside of a patch. On a sphere it is the nearest point to the middle.
VDWMESH_HD inline FoundPoint inner_midpoint(const SurfacePatch& patch, const Vec3d& u,
                                            const Vec3d& v) {
  if (patch.kind == PatchKind::saddle) return saddle_midpoint(patch, u, v);
  return nearest_on_sphere({patch.center, patch.radius}, midpoint(u, v));
}

// The midpoint of an edge between two different patches, on the circle in which they meet:
//
//   contact, saddle    the middle of the shorter arc
//   concave, concave   the same
//   saddle, concave    that of saddle_midpoint(), or if the torus reaches its axis the point of the
//                      probe's sphere that is nearest to the middle of the ends
//
// Not found for kinds of patches that never meet in a curve.
VDWMESH_HD inline FoundPoint curve_midpoint(const SurfacePatch& a, const SurfacePatch& b,
                                            const Vec3d& u, const Vec3d& v) {
  const bool in_order = a.kind <= b.kind;
  const SurfacePatch &first = in_order ? a : b, &second = in_order ? b : a;
  if (first.kind == PatchKind::contact && second.kind == PatchKind::saddle) {
    return arc_midpoint_about(second.center, second.axis, u, v);
  }
  if (first.kind == PatchKind::contact || second.kind != PatchKind::concave) return {u, false};
  const Sphere one{first.center, first.radius}, other{second.center, second.radius};
  if (first.kind == PatchKind::concave) {
    return precedes(other, one) ? arc_midpoint(other, one, u, v) : arc_midpoint(one, other, u, v);
  }
  return first.ring_radius > first.radius ? saddle_midpoint(first, u, v)
                                          : nearest_on_sphere(other, midpoint(u, v));
}

// The distance (Å) of p from the sphere or torus of a patch.
VDWMESH_HD inline double patch_residual(const SurfacePatch& patch, const Vec3d& p) {
  const PatchFooting f = footing(patch, p);
  if (f.girth > 0) return std::abs(norm(f.to_center) - patch.radius);
  // On the axis of a saddle all probes of its circle are equally far.
  const double height = dot(p - patch.center, patch.axis);
  const double square = height * height + patch.ring_radius * patch.ring_radius;
  return std::abs(std::sqrt(square) - patch.radius);
}

}  // namespace vdwmesh
