// Circles and corners of grown balls in wide numbers: the formulas of the complex's shapes, with
// squared radii that are a little larger.
#include "excluded/probes/wide_probes.hpp"

#include <cmath>

namespace vdwmesh::excluded {
namespace {

// If two numbers up to 1 differ by more than this in double, the larger one is certain. A corner in
// double has lost four digits at most; a corner that would lose more is computed with more digits.
constexpr double kSurelyApart = 1e-11;

WideVector wide(const Vec3d& v) { return {WideFloat(v.x), WideFloat(v.y), WideFloat(v.z)}; }

bool is_apart(double a, double b) { return std::abs(a - b) > kSurelyApart; }

}  // namespace

template <>
WideFloat root_of(const WideFloat& x) {
  const double rounded = to_double(x);
  if (!std::isnormal(rounded) || rounded < 0) return sqrt(x);
  // 53 digits of the inverse root become 105, then 209. The last step doubles those of the root.
  WideFloat inverse = 1 / std::sqrt(rounded);
  for (int step = 0; step < 2; ++step) inverse += inverse * (1 - x * inverse * inverse) / 2;
  const WideFloat root = x * inverse;
  return root + inverse * (x - root * root) / 2;
}

WideCircle wide_circle(const Sphere& a, const Sphere& b) {
  const WideVector ab = numbers::from_to<WideFloat>(a, b), at_a = wide(a.center);
  const WideFloat ra(a.radius), rb(b.radius), squared_length = dot(ab, ab);
  const WideFloat part = (squared_length + (ra - rb) * (ra + rb)) / (2 * squared_length);
  const WideFloat inverse = 1 / sqrt(squared_length);
  return {{at_a.x + part * ab.x, at_a.y + part * ab.y, at_a.z + part * ab.z},
          {inverse * ab.x, inverse * ab.y, inverse * ab.z},
          ra * ra + kGrowth - part * part * squared_length};
}

WideVector wide_corner(const AccessibleSurface& surface, CornerIndex corner) {
  const auto& v = surface.triangle_of(corner).vertices;
  const auto& balls = surface.triangulation().balls;
  const WideVector from = wide(balls[v[0]].center);
  const WideVector to =
      common_points_wide(balls[v[0]], balls[v[1]], balls[v[2]], kGrowth)[corner % 2];
  return {from.x + to.x, from.y + to.y, from.z + to.z};
}

bool is_circle_below(const Sphere& a, const Sphere& b, double probe_radius, double measured) {
  if (is_apart(measured, probe_radius)) return measured < probe_radius;
  const WideFloat p(probe_radius);
  return wide_circle(a, b).squared_radius < p * p;
}

bool is_corner_below(const std::array<Sphere, 3>& balls, double probe_radius, double measured) {
  if (is_apart(measured, probe_radius)) return measured < probe_radius;
  const auto [above, below] = common_points_wide(balls[0], balls[1], balls[2], kGrowth);
  const WideVector chord{above.x - below.x, above.y - below.y, above.z - below.z};
  const WideFloat p(probe_radius);
  return dot(chord, chord) < 4 * p * p;
}

double cusp_height(const Sphere& a, const Sphere& b, double probe_radius, double measured) {
  // Above this share of the probe's radius the difference of squares loses more than two digits.
  constexpr double kNearlyEqual = 0.99;
  const double p = probe_radius;
  if (measured < kNearlyEqual * p) return std::sqrt((p - measured) * (p + measured));
  const WideFloat square = WideFloat(p) * WideFloat(p) - wide_circle(a, b).squared_radius;
  return square > 0 ? static_cast<double>(WideFloat(sqrt(square))) : 0;
}

}  // namespace vdwmesh::excluded
