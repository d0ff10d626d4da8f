// Nearest points on a sphere, on the circle of two spheres and on the corner of three, and the ball
// nearest to a point: the geometry behind projection onto the union, for host and device. d is the
// distance of a point to a ball's centre, r the ball's radius.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/blended/field_formulas.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// The answer of a search for a point that may not exist.
struct FoundPoint {
  Vec3d position;  // meaningless unless found
  bool found;
};

// from + length * direction, with one rounding per coordinate.
VDWMESH_HD inline Vec3d along(const Vec3d& from, double length, const Vec3d& direction) {
  using std::fma;
  return {fma(length, direction.x, from.x), fma(length, direction.y, from.y),
          fma(length, direction.z, from.z)};
}

// d - r: the signed distance (Å) of p to the sphere, negative inside.
VDWMESH_HD inline double gap(const Sphere& s, const Vec3d& p) {
  return std::sqrt(squared_distance(p, s.center)) - s.radius;
}

// The point of the sphere nearest to p. Not found if p is its centre.
VDWMESH_HD inline FoundPoint nearest_on_sphere(const Sphere& s, const Vec3d& p) {
  const Vec3d out = p - s.center;
  const double distance = std::sqrt(squared_distance(p, s.center));
  if (!(distance > 0)) return {p, false};
  return {along(s.center, s.radius / distance, out), true};
}

// The point nearest to p on the circle in which two spheres meet. Not found if they do not cross,
// or if p lies on the line of their centres, from which all points of the circle are equally far.
VDWMESH_HD inline FoundPoint nearest_on_circle(const Sphere& a, const Sphere& b, const Vec3d& p) {
  using std::fma;
  const Vec3d axis = b.center - a.center;
  const double square = squared_norm(axis);
  if (!(square > 0)) return {p, false};
  // The circle's plane cuts the axis at this fraction of it from a's centre: a point with equal
  // power d^2 - r^2 for both spheres has (D^2 + ra^2 - rb^2) / 2 D^2, with D the distance of the
  // centres. The difference of squares is written as a product, which rounds better for like radii.
  const double plane = 0.5 * (square + (a.radius - b.radius) * (a.radius + b.radius)) / square;
  const double circle_square = fma(a.radius, a.radius, -(plane * plane) * square);
  if (!(circle_square > 0)) return {p, false};
  const Vec3d from_a = p - a.center;
  const Vec3d radial = along(from_a, -(dot(from_a, axis) / square), axis);
  const double length = norm(radial);
  // The subtraction of two vectors as long as from_a leaves an error of a few 2^-53 = 1e-16 of that
  // length. A radial vector of less than 1e-14 of it could owe its direction to that error.
  if (!(length > 1e-14 * norm(from_a))) return {p, false};
  const Vec3d middle = along(a.center, plane, axis);
  return {along(middle, std::sqrt(circle_square) / length, radial), true};
}

// The nearest corner of three spheres. They have two points in common, one on each side of the
// plane of their centres; the point on p's side is returned. Not found if the spheres have no
// common point, or if the centres are collinear.
//
// Let x be measured from a's centre, and let u and v be the vectors to the other two centres.
// Points of equal power d^2 - r^2 for all three spheres satisfy the two equations dot(x, u) = bu
// and dot(x, v) = bv. Cramer's rule gives `foot`, their solution in the plane of the centres. The
// corners lie on both sides of it, at the height sqrt(ra^2 - |foot|^2) above the plane. `across` is
// normal to the plane and has the length sqrt(det).
VDWMESH_HD inline FoundPoint nearest_corner(const Sphere& a, const Sphere& b, const Sphere& c,
                                            const Vec3d& p) {
  using std::fma;
  const Vec3d u = b.center - a.center, v = c.center - a.center;
  const Vec3d across = cross(u, v);
  const double det = squared_norm(across);  // = uu vv - uv^2, the determinant of the equations
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

// The answer of a search for the ball nearest to a point; meaningless unless found.
struct NearestBall {
  double gap;  // d - r of the ball, Å
  ListPlace place;
  bool found;
};

// The ball of least d - r among those with d - r of at most `margin` (Å), a margin around their
// surfaces. Ties go to the ball of lowest rank in canonical order. The visitor returns false so
// that visit_near_box() goes on to the next ball.
VDWMESH_HD inline NearestBall nearest_ball_within(const CellListView& list, const Vec3d& p,
                                                  double margin) {
  const Vec3d lower{p.x - margin, p.y - margin, p.z - margin};
  const Vec3d upper{p.x + margin, p.y + margin, p.z + margin};
  NearestBall best{margin, ListPlace{}, false};
  visit_near_box(list, lower, upper, [&](ListPlace place) {
    const Sphere& ball = list.spheres[place];
    const double square = squared_distance(p, ball.center);
    // Rejects most balls without a square root. best.gap is the least d - r so far, or `margin`
    // before the first ball; this ball is no better if d > best.gap + r. The relative slack of
    // 1e-12 is thousands of times the rounding of the squares (2^-53 = 1e-16), so no better ball is
    // lost.
    const double most = best.gap + ball.radius;
    if (most < 0 || square > most * most * (1 + 1e-12)) return false;
    const double g = std::sqrt(square) - ball.radius;
    const bool tie = best.found && g == best.gap;
    if (tie ? list.rank[place] < list.rank[best.place] : g <= best.gap) best = {g, place, true};
    return false;
  });
  return best;
}

// The ball of least d - r among those with d - r of at most `reach` (Å), found in one search or
// two. Most points lie inside the union or on its boundary. Then d - r of some ball is at most
// `near`, a smaller margin, and the narrow search finds the answer quickly. The wide search runs
// only if the narrow one finds no ball.
VDWMESH_HD inline NearestBall nearest_ball(const CellListView& list, const Vec3d& p, double near,
                                           double reach) {
  const NearestBall best = nearest_ball_within(list, p, near);
  return best.found ? best : nearest_ball_within(list, p, reach);
}

// Whether a comes before b in the canonical order (x, y, z, r). Equal spheres precede neither way.
VDWMESH_HD inline bool precedes(const Sphere& a, const Sphere& b) {
  if (a.center.x != b.center.x) return a.center.x < b.center.x;
  if (a.center.y != b.center.y) return a.center.y < b.center.y;
  if (a.center.z != b.center.z) return a.center.z < b.center.z;
  return a.radius < b.radius;
}

}  // namespace vdwmesh
