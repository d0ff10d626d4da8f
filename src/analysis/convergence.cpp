#include "analysis/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

struct Point {
  double x, y;
};

void check(std::span<const double> sizes, std::span<const double> values) {
  if (sizes.size() != values.size()) {
    throw InvalidInput(fmt::format("{} sizes, but {} values", sizes.size(), values.size()));
  }
  for (const double size : sizes) {
    if (!(std::isfinite(size) && size > 0)) {
      throw InvalidInput(fmt::format("size {}: needs a finite number above 0", size));
    }
  }
}

std::vector<Point> logarithms(std::span<const double> sizes, std::span<const double> errors) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (errors[i] == 0 || !std::isfinite(errors[i])) continue;
    points.push_back({std::log(sizes[i]), std::log(std::abs(errors[i]))});
  }
  return points;
}

template <class Term>
double sum(const std::vector<Point>& points, Term&& term) {
  WideSum total;
  for (const Point& p : points) total.add(term(p));
  return total.value();
}

// Of three points with rising x: how much steeper the values rise towards the coarse end,
// (y3 - y2) / (y2 - y1), and what a power of the sizes would give.
using Three = std::array<Point, 3>;

double ratio_of_differences(const Three& p) { return (p[2].y - p[1].y) / (p[1].y - p[0].y); }

// Written with expm1, so that small orders do not cancel.
double ratio_of_powers(const Three& p, double order) {
  return std::expm1(order * std::log(p[2].x / p[1].x)) /
         -std::expm1(order * std::log(p[0].x / p[1].x));
}

std::optional<Three> three_smallest(std::span<const double> sizes, std::span<const double> values) {
  std::vector<Point> points;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (std::isfinite(values[i])) points.push_back({sizes[i], values[i]});
  }
  std::ranges::sort(points, {}, &Point::x);
  const auto same_size = [](const Point& a, const Point& b) { return a.x == b.x; };
  points.erase(std::unique(points.begin(), points.end(), same_size), points.end());
  if (points.size() < 3) return std::nullopt;
  return Three{points[0], points[1], points[2]};
}

}  // namespace

std::optional<PowerLaw> fit_power_law(std::span<const double> sizes,
                                      std::span<const double> errors) {
  check(sizes, errors);
  const std::vector<Point> points = logarithms(sizes, errors);
  if (points.empty()) return std::nullopt;
  const auto n = static_cast<double>(points.size());
  const double x = sum(points, [](const Point& p) { return p.x; }) / n;
  const double y = sum(points, [](const Point& p) { return p.y; }) / n;
  const double xx = sum(points, [&](const Point& p) { return (p.x - x) * (p.x - x); });
  const bool one_size = std::ranges::all_of(points, [&](Point p) { return p.x == points[0].x; });
  if (one_size) return std::nullopt;
  const double order = sum(points, [&](const Point& p) { return (p.x - x) * (p.y - y); }) / xx;
  const auto residual = [&](const Point& p) { return p.y - y - order * (p.x - x); };
  const double squares = sum(points, [&](const Point& p) { return residual(p) * residual(p); });
  return PowerLaw{order, std::exp(y - order * x), std::sqrt(squares / n), points.size()};
}

std::optional<Extrapolation> extrapolate(std::span<const double> sizes,
                                         std::span<const double> values) {
  check(sizes, values);
  const std::optional<Three> points = three_smallest(sizes, values);
  if (!points) return std::nullopt;
  const Three& p = *points;
  // The ratio of powers rises with the order, so there is at most one that fits.
  const double wanted = ratio_of_differences(p);
  const auto excess = [&](double order) { return ratio_of_powers(p, order) - wanted; };
  const double low = excess(kMinExtrapolationOrder), high = excess(kMaxExtrapolationOrder);
  if (!(low <= 0 && high >= 0)) return std::nullopt;
  std::uintmax_t steps = 100;
  const auto bracket =
      boost::math::tools::toms748_solve(excess, kMinExtrapolationOrder, kMaxExtrapolationOrder, low,
                                        high, boost::math::tools::eps_tolerance<double>(50), steps);
  const double order = (bracket.first + bracket.second) / 2;
  const double growth = std::expm1(order * std::log(p[1].x / p[0].x));
  return Extrapolation{p[0].y - (p[1].y - p[0].y) / growth, order};
}

}  // namespace vdwmesh
