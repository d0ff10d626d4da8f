// The parts of a plane convex polygon inside and outside a disc, edge by edge, in closed form. For
// the library's own use.
//
// The disc is a plane's section with a ball of radius R at height h over the plane; o is the foot
// of the ball's centre, and the disc has the squared radius R² - h². The polygon is the signed sum
// of the triangles from o to its edges. On an edge at signed distance d from o (positive if o is on
// its inner side), s runs along the edge from the foot of o. The solid angle of the right triangle
// with the legs d and s, seen from the centre, is
//   atan(s / d) - atan(h s / (d sqrt(h² + d² + s²))),
// and that of a sector of the disc is its angle times 1 - h / R. So nothing has to be decided: not
// whether o or the centre is inside, and a plane through the centre is no special case.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec3.hpp"

namespace vdwmesh {

struct DiscPieces {
  double area = 0;         // of polygon ∩ disc
  double angle = 0;        // of the circle's arcs in the polygon
  double solid_angle = 0;  // of the polygon outside the disc, seen from the centre; signed as h is
};

// Adds what belongs to the edge from p to q, counter-clockwise about the unit normal n. Both are
// relative to the foot o.
inline void add_edge_pieces(DiscPieces& sum, const Vec3d& p, const Vec3d& q, const Vec3d& n,
                            double height, double radius) {
  const Vec3d along = q - p;
  const double length = norm(along);
  if (!(length > 0)) return;
  const Vec3d unit = 1 / length * along;
  const double d = dot(n, cross(p, unit));
  if (d == 0) return;  // the triangle is flat
  const double squared_disc = (radius - height) * (radius + height);
  const double squared_chord = squared_disc - d * d;
  const double chord = squared_chord > 0 ? std::sqrt(squared_chord) : 0;
  const double first = dot(p, unit), last = dot(q, unit);
  const double sine = std::clamp(height / radius, -1.0, 1.0), sign = d < 0 ? -1 : 1;
  const auto lift = [&](double s) {
    const double slant = std::sqrt(height * height + d * d + s * s);
    return sign * std::atan2(height * s, std::abs(d) * slant);
  };
  const auto add_outside = [&](double from, double to) {
    if (!(from < to)) return;
    const double angle = std::atan2(d * (to - from), d * d + from * to);
    sum.solid_angle += angle * sine - (lift(to) - lift(from));
    if (squared_disc <= 0) return;
    sum.angle += angle;
    sum.area += squared_disc * angle / 2;
  };
  if (chord == 0) return add_outside(first, last);
  add_outside(first, std::min(last, -chord));
  add_outside(std::max(first, chord), last);
  const double inside = std::min(last, chord) - std::max(first, -chord);
  if (inside > 0) sum.area += d * inside / 2;
}

}  // namespace vdwmesh
