// angle(): a table of directions whose angles MPFR encloses, and the series of the arc tangent for
// what is left, with bounds of all errors.
#include "measures/certificate/interval.hpp"

#include <mpfr.h>

#include <array>
#include <cmath>

namespace vdwmesh::certificate {
namespace {

// Directions from angle 0 to π: three sides of the square [-16, 16] × [0, 16], in steps of 1.
constexpr int kSide = 16, kDirections = 4 * kSide + 1;

struct Direction {
  double x, y;
  double lower, upper;  // of its angle
};

// The angle in double, rounded as asked. MPFR rounds correctly.
double angle_of(int y, int x, mpfr_rnd_t direction) {
  mpfr_t angle, abscissa;
  mpfr_init2(angle, 53);
  mpfr_init2(abscissa, 53);
  mpfr_set_si(angle, y, MPFR_RNDN);
  mpfr_set_si(abscissa, x, MPFR_RNDN);
  mpfr_atan2(angle, angle, abscissa, direction);
  const double rounded = mpfr_get_d(angle, direction);
  mpfr_clear(angle);
  mpfr_clear(abscissa);
  return rounded;
}

std::array<Direction, kDirections> make_directions() {
  std::array<Direction, kDirections> directions{};
  for (int k = 0; k < kDirections; ++k) {
    const int x = std::clamp(2 * kSide - k, -kSide, kSide), y = std::min({k, kSide, 4 * kSide - k});
    directions[static_cast<std::size_t>(k)] = {static_cast<double>(x), static_cast<double>(y),
                                               angle_of(y, x, MPFR_RNDD),
                                               angle_of(y, x, MPFR_RNDU)};
  }
  mpfr_free_cache2(MPFR_FREE_LOCAL_CACHE);  // what MPFR keeps of π for this thread
  return directions;
}

const std::array<Direction, kDirections>& directions() {
  static const std::array<Direction, kDirections> table = make_directions();
  return table;
}

Interval whole_half_turn() { return {0, directions().back().upper}; }

// The direction next to (x, y) with y >= 0. Rounding may make it the second-nearest, which angle()
// notices if it matters. Precondition: the quotient of the coordinates is a number.
const Direction& nearest(double y, double x) {
  const double size = std::max(std::abs(x), y), across = y < std::abs(x) ? y : x;
  // The conversion cuts off, which rounds a positive number down.
  const int step = static_cast<int>(kSide * (across / size) + (kSide + 0.5)) - kSide;
  const int k = y >= std::abs(x) ? 2 * kSide - step : (x > 0 ? step : 4 * kSide - step);
  return directions()[static_cast<std::size_t>(k)];
}

// |z| beyond this does not come from the nearest direction: 1/32 and 1/16 of it for rounding.
constexpr double kMostTangent = (1 + 0x1p-4) / 32;

// atan(z) for |z| <= kMostTangent, as z + f(z), where f(z) = -z³/3 + z⁵/5 - ... + z¹¹/11 is
// computed for one number in the interval.
// - What the series leaves out is less than |z|¹³/13 < 5e-21, because the series alternates.
// - f is computed in 16 roundings of a relative 2^-52 each, in whatever direction. No digits
//   cancel, because each bracket is 1/n less something a thousand times smaller. |f| < 1.3e-5, so
//   the error is less than 17 × 2^-52 × 1.3e-5 < 5e-20.
// - For other numbers of the interval f differs by at most its width times |f'| <= z² < 2^-9.
// Both errors of the first two kinds together are below 2^-63; half of kError is left for the
// rounding of the bounds.
Interval arc_tangent(const Interval& z) {
  constexpr double kError = 0x1p-62, kMostSlope = 0x1p-9;
  const double t = z.inf(), w = t * t;
  const double f =
      -t * w * (1.0 / 3 - w * (1.0 / 5 - w * (1.0 / 7 - w * (1.0 / 9 - w * (1.0 / 11)))));
  const double error = kError + width(z) * kMostSlope;
  return z + Interval(-(error - f), f + error);
}

}  // namespace

Interval pi(const Interval&) { return {directions().back().lower, directions().back().upper}; }

Interval angle(const Interval& y_or_less, const Interval& x) {
  const Interval y = at_least_zero(y_or_less);
  const double x_middle = middle(x), y_middle = middle(y);
  if (!(std::max(std::abs(x_middle), y_middle) > 0) || !std::isfinite(x_middle + y_middle)) {
    return whole_half_turn();
  }
  const Direction& d = nearest(y_middle, x_middle);
  const Interval along = x * d.x + y * d.y, across = y * d.x - x * d.y;
  if (!(along.inf() > 0)) return whole_half_turn();
  const Interval z = across / along;
  if (!(z.inf() >= -kMostTangent && z.sup() <= kMostTangent)) return whole_half_turn();
  return within(0, directions().back().upper, Interval(d.lower, d.upper) + arc_tangent(z));
}

}  // namespace vdwmesh::certificate
