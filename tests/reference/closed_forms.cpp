#include "reference/closed_forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vdwmesh::reference {
namespace {

constexpr double kPi = std::numbers::pi;

// Height of the cap of ball 1 that lies in ball 2, for balls that overlap properly.
double hidden_height(double r1, double r2, double d) {
  return r1 - (d * d + r1 * r1 - r2 * r2) / (2 * d);
}

Point unit(const Point& p) { return (1 / length(p)) * p; }

// Where three spheres meet: `foot` in the plane of the centres, the points `half_chord` above and
// below it.
struct CommonChord {
  Point up, foot;
  double half_chord;
};

CommonChord common_chord(const std::array<Ball, 3>& b) {
  const Point u = unit(b[1].center - b[0].center);
  const Point up = unit(outer(u, b[2].center - b[0].center)), v = outer(up, u);
  // Trilateration in the frame (u, v) about the first centre.
  const double d = distance(b[0].center, b[1].center);
  const double i = inner(u, b[2].center - b[0].center), j = inner(v, b[2].center - b[0].center);
  const double r0 = b[0].radius, r1 = b[1].radius, r2 = b[2].radius;
  const double x = (r0 * r0 - r1 * r1 + d * d) / (2 * d);
  const double y = (r0 * r0 - r2 * r2 + i * i + j * j) / (2 * j) - i / j * x;
  return {up, b[0].center + x * u + y * v, std::sqrt(r0 * r0 - x * x - y * y)};
}

// The arc that spheres a and b leave on the boundary, from the upper point to the lower one.
struct CreaseArc {
  Point center, normal, tangent;  // it turns about `normal`; `tangent` at the upper point
  double radius, angle;
};

CreaseArc crease_arc(const CommonChord& chord, const Ball& a, const Ball& b, const Ball& third) {
  Point ray = unit(outer(chord.up, b.center - a.center));
  if (inner(ray, third.center - a.center) > 0) ray = -1.0 * ray;
  const double middle = inner(a.center - chord.foot, ray), h = chord.half_chord;
  const double radius = std::hypot(middle, h);
  return {chord.foot + middle * ray, outer(chord.up, ray),
          (1 / radius) * (h * ray + middle * chord.up), radius, 2 * std::atan2(h, -middle)};
}

// Integral of x cross dx / 2 along the arc, from end to end.
Point swept_area(const CreaseArc& arc, const Point& along_chord) {
  return 0.5 *
         (outer(arc.center, along_chord) + (arc.radius * arc.radius * arc.angle) * arc.normal);
}

}  // namespace

Measures ball(double r) { return {4 * kPi * r * r, 4 * kPi / 3 * r * r * r}; }

Measures cap(double r, double h) { return {2 * kPi * r * h, kPi * h * h * (3 * r - h) / 3}; }

double lens_volume(double r1, double r2, double d) {
  if (d >= r1 + r2) return 0;
  if (d <= std::abs(r1 - r2)) return ball(std::min(r1, r2)).volume;
  return cap(r1, hidden_height(r1, r2, d)).volume + cap(r2, hidden_height(r2, r1, d)).volume;
}

Measures two_balls(double r1, double r2, double d) {
  const Measures a = ball(r1), b = ball(r2);
  if (d <= std::abs(r1 - r2)) return r1 > r2 ? a : b;
  if (d >= r1 + r2) return {a.area + b.area, a.volume + b.volume};
  return {a.area + b.area - cap(r1, hidden_height(r1, r2, d)).area -
              cap(r2, hidden_height(r2, r1, d)).area,
          a.volume + b.volume - lens_volume(r1, r2, d)};
}

Measures three_balls(const std::array<Ball, 3>& balls) {
  const CommonChord chord = common_chord(balls);
  const Point down = (-2 * chord.half_chord) * chord.up;
  Measures sum{0, 0};
  for (std::size_t k = 0; k < 3; ++k) {
    const Ball &a = balls[k], &b = balls[(k + 1) % 3], &c = balls[(k + 2) % 3];
    const CreaseArc before = crease_arc(chord, a, c, b), after = crease_arc(chord, a, b, c);
    const double corner = std::acos(inner(before.tangent, after.tangent));
    const auto to_plane = [&](const Ball& other, const CreaseArc& arc) {
      return inner(arc.center - a.center, unit(other.center - a.center));
    };
    const double area =
        2 * a.radius * a.radius * corner +
        a.radius * (to_plane(c, before) * before.angle + to_plane(b, after) * after.angle);
    // Counter-clockwise: down along the one arc, up along the other.
    const Point normals = swept_area(before, down) - swept_area(after, down);
    sum.area += area;
    sum.volume += (a.radius * area + inner(a.center, normals)) / 3;
  }
  return sum;
}

Measures ring_of_balls(int n, double ring_radius, double r) {
  const double d = 2 * ring_radius * std::sin(kPi / n);
  const Measures one = ball(r), hidden = cap(r, r - d / 2);
  return {n * (one.area - 2 * hidden.area), n * (one.volume - 2 * hidden.volume)};
}

}  // namespace vdwmesh::reference
