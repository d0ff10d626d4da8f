// Orders of convergence: a power law fitted to errors, and Richardson extrapolation of values.
//
// fit_power_law() is a linear regression on logarithms, because |error| = scale · size^order is the
// straight line ln |error| = ln scale + order · ln size. extrapolate() solves for the order at
// which the model value = limit + constant · size^order passes through three values. The limit and
// the constant are eliminated first, which leaves one equation in the order (ratio_of_powers()); a
// bracketing root finder solves it. docs/studies.md shows the results of both.
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

struct LogPoint {
  double x, y;  // (ln size, ln |error|) in the fit, (size, value) in the extrapolation
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

// Returns the points (ln size, ln |error|), without errors that are 0 or not finite.
std::vector<LogPoint> logarithms(std::span<const double> sizes, std::span<const double> errors) {
  std::vector<LogPoint> points;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (errors[i] == 0 || !std::isfinite(errors[i])) continue;
    points.push_back({std::log(sizes[i]), std::log(std::abs(errors[i]))});
  }
  return points;
}

// Returns the sum of term(point) over all points.
template <class Term>
double sum(const std::vector<LogPoint>& points, Term&& term) {
  WideSum total;
  for (const LogPoint& p : points) total.add(term(p));
  return total.value();
}

// Three points (size, value) with increasing sizes x1 < x2 < x3.
using Three = std::array<LogPoint, 3>;

// Returns (y3 - y2) / (y2 - y1). In this ratio limit and constant of the model cancel.
double ratio_of_differences(const Three& p) { return (p[2].y - p[1].y) / (p[1].y - p[0].y); }

// Returns the ratio (y3 - y2) / (y2 - y1) for the model y = x^k, where k is the order:
// (x3^k - x2^k) / (x2^k - x1^k). Numerator and denominator are divided by x2^k, which gives
// ((x3/x2)^k - 1) / (1 - (x1/x2)^k). expm1 computes both differences without cancellation when k
// is small.
double ratio_of_powers(const Three& p, double order) {
  return std::expm1(order * std::log(p[2].x / p[1].x)) /
         -std::expm1(order * std::log(p[0].x / p[1].x));
}

// Returns the points with finite values at the three smallest different sizes, if there are three.
std::optional<Three> three_smallest(std::span<const double> sizes, std::span<const double> values) {
  std::vector<LogPoint> points;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (std::isfinite(values[i])) points.push_back({sizes[i], values[i]});
  }
  std::ranges::sort(points, {}, &LogPoint::x);
  const auto same_size = [](const LogPoint& a, const LogPoint& b) { return a.x == b.x; };
  points.erase(std::unique(points.begin(), points.end(), same_size), points.end());
  if (points.size() < 3) return std::nullopt;
  return Three{points[0], points[1], points[2]};
}

}  // namespace

std::optional<PowerLaw> fit_power_law(std::span<const double> sizes,
                                      std::span<const double> errors) {
  check(sizes, errors);
  const std::vector<LogPoint> points = logarithms(sizes, errors);
  if (points.empty()) return std::nullopt;
  // The regression uses the means x, y and sums of centred products: order = Sxy / Sxx.
  const auto n = static_cast<double>(points.size());
  const double x = sum(points, [](const LogPoint& p) { return p.x; }) / n;
  const double y = sum(points, [](const LogPoint& p) { return p.y; }) / n;
  const double xx = sum(points, [&](const LogPoint& p) { return (p.x - x) * (p.x - x); });
  const bool one_size = std::ranges::all_of(points, [&](LogPoint p) { return p.x == points[0].x; });
  if (one_size) return std::nullopt;
  const double order = sum(points, [&](const LogPoint& p) { return (p.x - x) * (p.y - y); }) / xx;
  const auto residual = [&](const LogPoint& p) { return p.y - y - order * (p.x - x); };
  const double squares = sum(points, [&](const LogPoint& p) { return residual(p) * residual(p); });
  return PowerLaw{order, std::exp(y - order * x), std::sqrt(squares / n), points.size()};
}

std::optional<Extrapolation> extrapolate(std::span<const double> sizes,
                                         std::span<const double> values) {
  check(sizes, values);
  const std::optional<Three> points = three_smallest(sizes, values);
  if (!points) return std::nullopt;
  const Three& p = *points;
  // The ratio of powers increases with the order, so at most one order gives the ratio `wanted`. If
  // `wanted` is not finite, or that order is outside the bounds, the test of `low` and `high` below
  // fails, and the result is empty.
  const double wanted = ratio_of_differences(p);
  const auto excess = [&](double order) { return ratio_of_powers(p, order) - wanted; };
  const double low = excess(kMinExtrapolationOrder), high = excess(kMaxExtrapolationOrder);
  if (!(low <= 0 && high >= 0)) return std::nullopt;
  // TOMS 748 ends when the bracket agrees in 50 bits; 100 steps are far more than it needs.
  std::uintmax_t steps = 100;
  const auto bracket =
      boost::math::tools::toms748_solve(excess, kMinExtrapolationOrder, kMaxExtrapolationOrder, low,
                                        high, boost::math::tools::eps_tolerance<double>(50), steps);
  const double order = (bracket.first + bracket.second) / 2;
  // The model at the first two points gives the limit: limit = y1 - C x1^p with the constant C of
  // the model, and C x1^p = (y2 - y1) / ((x2/x1)^p - 1).
  const double growth = std::expm1(order * std::log(p[1].x / p[0].x));
  return Extrapolation{p[0].y - (p[1].y - p[0].y) / growth, order};
}

}  // namespace vdwmesh
