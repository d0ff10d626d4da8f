// Where spheres meet, and which one is nearest: the geometry behind projection onto the union, for
// host and device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/blended/field_formulas.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

struct FoundPoint {
  Vec3d position;
  bool found;
};

VDWMESH_HD inline Vec3d along(const Vec3d& from, double length, const Vec3d& direction) {
  using std::fma;
  return {fma(length, direction.x, from.x), fma(length, direction.y, from.y),
          fma(length, direction.z, from.z)};
}

// Signed distance of p to the sphere, negative inside. Å.
VDWMESH_HD inline double gap(const Sphere& s, const Vec3d& p) {
  return std::sqrt(squared_distance(p, s.center)) - s.radius;
}

// The point of the sphere nearest to p. Not found from its centre.
VDWMESH_HD inline FoundPoint nearest_on_sphere(const Sphere& s, const Vec3d& p) {
  const Vec3d out = p - s.center;
  const double distance = std::sqrt(squared_distance(p, s.center));
  if (!(distance > 0)) return {p, false};
  return {along(s.center, s.radius / distance, out), true};
}

// The point of the circle of two spheres nearest to p. Not found where they do not cross, or from
// the line of their centres.
VDWMESH_HD inline FoundPoint nearest_on_circle(const Sphere& a, const Sphere& b, const Vec3d& p) {
  using std::fma;
  const Vec3d axis = b.center - a.center;
  const double square = squared_norm(axis);
  if (!(square > 0)) return {p, false};
  // Place of the circle's plane along the axis, in units of the axis, from a's centre.
  const double plane = 0.5 * (square + (a.radius - b.radius) * (a.radius + b.radius)) / square;
  const double circle_square = fma(a.radius, a.radius, -(plane * plane) * square);
  if (!(circle_square > 0)) return {p, false};
  const Vec3d from_a = p - a.center;
  const Vec3d radial = along(from_a, -(dot(from_a, axis) / square), axis);
  const double length = norm(radial);
  // Below this the direction would be nothing but rounding.
  if (!(length > 1e-14 * norm(from_a))) return {p, false};
  const Vec3d middle = along(a.center, plane, axis);
  return {along(middle, std::sqrt(circle_square) / length, radial), true};
}

// That of the two points common to three spheres which lies on p's side of the plane of their
// centres. Not found where there is none.
VDWMESH_HD inline FoundPoint nearest_corner(const Sphere& a, const Sphere& b, const Sphere& c,
                                            const Vec3d& p) {
  using std::fma;
  const Vec3d u = b.center - a.center, v = c.center - a.center;
  const Vec3d across = cross(u, v);
  const double det = squared_norm(across);
  if (!(det > 0)) return {p, false};
  const double uu = squared_norm(u), vv = squared_norm(v), uv = dot(u, v);
  const double bu = 0.5 * (uu + (a.radius - b.radius) * (a.radius + b.radius));
  const double bv = 0.5 * (vv + (a.radius - c.radius) * (a.radius + c.radius));
  const double su = (bu * vv - bv * uv) / det;
  const double sv = (bv * uu - bu * uv) / det;
  const Vec3d foot = along(su * u, sv, v);
  const double height_square = fma(a.radius, a.radius, -squared_norm(foot));
  if (!(height_square > 0)) return {p, false};
  const double side = dot(p - a.center, across) < 0 ? -1.0 : 1.0;
  return {along(a.center + foot, side * std::sqrt(height_square / det), across), true};
}

struct NearestBall {
  double gap;           // d - r of it, Å
  std::uint32_t place;  // in the list
  bool found;
};

// The ball of least d - r among those that come within `margin` (Å) of p; ties: lowest rank.
VDWMESH_HD inline NearestBall nearest_ball_within(const CellListView& list, const Vec3d& p,
                                                  double margin) {
  const Vec3d lower{p.x - margin, p.y - margin, p.z - margin};
  const Vec3d upper{p.x + margin, p.y + margin, p.z + margin};
  NearestBall best{margin, 0, false};
  visit_near_box(list, lower, upper, [&](std::uint32_t place) {
    const Sphere& ball = list.spheres[place];
    const double square = squared_distance(p, ball.center);
    // Spares most square roots; the slack is many times their rounding, so no tie is lost.
    const double most = best.gap + ball.radius;
    if (most < 0 || square > most * most * (1 + 1e-12)) return false;
    const double g = std::sqrt(square) - ball.radius;
    const bool tie = best.found && g == best.gap;
    if (tie ? list.rank[place] < list.rank[best.place] : g <= best.gap) best = {g, place, true};
    return false;
  });
  return best;
}

// The same over all balls within `reach`. Most queries come from inside the union or from its
// boundary, where the balls that hold p are all that matter: the wide search waits until the one
// within `near` finds none.
VDWMESH_HD inline NearestBall nearest_ball(const CellListView& list, const Vec3d& p, double near,
                                           double reach) {
  const NearestBall best = nearest_ball_within(list, p, near);
  return best.found ? best : nearest_ball_within(list, p, reach);
}

// Whether a comes before b in canonical order (x, y, z, r), which breaks exact ties.
VDWMESH_HD inline bool precedes(const Sphere& a, const Sphere& b) {
  if (a.center.x != b.center.x) return a.center.x < b.center.x;
  if (a.center.y != b.center.y) return a.center.y < b.center.y;
  if (a.center.z != b.center.z) return a.center.z < b.center.z;
  return a.radius < b.radius;
}

}  // namespace vdwmesh
