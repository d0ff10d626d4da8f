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

Measures ring_of_balls(int n, double ring_radius, double r) {
  const double d = 2 * ring_radius * std::sin(kPi / n);
  const Measures one = ball(r), hidden = cap(r, r - d / 2);
  return {n * (one.area - 2 * hidden.area), n * (one.volume - 2 * hidden.volume)};
}

}  // namespace vdwmesh::reference
