#include "reference/field_oracle.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace vdwmesh::reference {
namespace {

// One atom's function of the distance d, and its derivative by d.
struct Radial {
  double value, derivative;
};

Radial product(const Radial& f, const Radial& g) {
  return {f.value * g.value, f.derivative * g.value + f.value * g.derivative};
}

Radial gaussian(double a, double b, double d) {
  const double value = a * std::exp(-b * d * d);
  return {value, -2 * b * d * value};
}

Radial soft_object(double a, double b, double d) {
  if (d > b) return {0, 0};
  const double x = d / b;
  return {a * (1 - 4. / 9 * std::pow(x, 6) + 17. / 9 * std::pow(x, 4) - 22. / 9 * x * x),
          a / b * (-24. / 9 * std::pow(x, 5) + 68. / 9 * std::pow(x, 3) - 44. / 9 * x)};
}

Radial inverse_square(double c, double smallest, double d) {
  if (d <= smallest) return {c / (smallest * smallest), 0};
  return {c / (d * d), -2 * c / (d * d * d)};
}

// w(d) = ((1 - d^2/D^2) / (1 - R^2/D^2))^2 for d < D = 2.5 R.
Radial window(double radius, double d) {
  const double end = 2.5 * radius;
  if (d >= end) return {0, 0};
  const double scale = 1 - radius * radius / (end * end);
  const double s = (1 - d * d / (end * end)) / scale;
  return {s * s, 2 * s * (-2 * d / (end * end)) / scale};
}

Radial radius_aware(const FieldOracle& field, double r, double d) {
  switch (field.function) {
    case Function::blinn:
      return product(gaussian(std::exp(field.blobbiness), field.blobbiness / (r * r), d),
                     window(r, d));
    case Function::inverse_squared:
      return product(inverse_square(r * r, 1e-3 * field.lattice.spacing, d), window(r, d));
    case Function::soft_object:
      return soft_object(2, 2 * r, d);
  }
  throw std::logic_error("unknown function");
}

Radial thesis(const FieldOracle& field, double d) {
  switch (field.function) {
    case Function::blinn:
      return gaussian(1, 0.8, d);
    case Function::inverse_squared:
      return inverse_square(1, 1e-3 * field.lattice.spacing, d);
    case Function::soft_object:
      return soft_object(1, 1.6, d);
  }
  throw std::logic_error("unknown function");
}

// Nodes v - n .. v + n around the voxel v of the atom, as a closed box.
bool in_sub_grid(const FieldOracle& field, const Point& center, const Point& p) {
  const double n = field.preset == Preset::thesis ? 20 : 4;
  const double h = field.lattice.spacing;
  for (std::size_t a = 0; a < 3; ++a) {
    const double voxel = std::floor((center[a] - field.lattice.origin[a]) / h);
    const double place = (p[a] - field.lattice.origin[a]) / h;
    // Nodes are computed with one rounding, so a node on the face may lie outside by a hair.
    if (std::abs(place - voxel) > n + 1e-9) return false;
  }
  return true;
}

Radial radial_part(const FieldOracle& field, const Ball& ball, const Point& p) {
  const double d = distance(ball.center, p);
  if (field.preset == Preset::radius_aware) return radius_aware(field, ball.radius, d);
  if (!in_sub_grid(field, ball.center, p)) return {0, 0};
  return thesis(field, d);
}

}  // namespace

double default_isovalue(const FieldOracle& field) {
  if (field.preset == Preset::radius_aware) return 1;
  if (field.preset == Preset::thesis_vdw) return 4.6;
  if (field.function == Function::blinn) return 0.70;
  return field.function == Function::soft_object ? 0.63 : 4.8;
}

FieldSample sample_field(const FieldOracle& field, const std::vector<Ball>& balls, const Point& p) {
  FieldSample sum{0, {0, 0, 0}};
  for (const Ball& ball : balls) {
    const Radial f = radial_part(field, ball, p);
    const Point r = p - ball.center;
    const double d = length(r);
    sum.value += f.value;
    if (d > 0) sum.gradient = sum.gradient + (f.derivative / d) * r;
  }
  return sum;
}

double contribution(const FieldOracle& field, const Ball& ball, const Point& p) {
  return radial_part(field, ball, p).value;
}

UnionSample sample_union(const std::vector<Ball>& balls, const Point& p) {
  UnionSample best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const double s = distance(balls[i].center, p) - balls[i].radius;
    if (s < best.signed_distance) best = {s, i};
  }
  return best;
}

std::optional<double> bisect(const Inside& inside, const Point& p, const Point& direction,
                             double reach) {
  double low = 0, high = reach;
  if (!inside(p) || inside(p + high * direction)) return std::nullopt;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (inside(p + middle * direction) ? low : high) = middle;
  }
  return low;
}

}  // namespace vdwmesh::reference
