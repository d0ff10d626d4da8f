// Intervals of doubles that contain the true value, and the functions of them that CGAL lacks.
//
// The type is CGAL's Interval_nt: sums, products, quotients and roots are rounded outward, if the
// processor rounds upward (upward_rounding.hpp). All functions here have this precondition.
#pragma once

#include <CGAL/Interval_nt.h>

#include <algorithm>
#include <cmath>

namespace vdwmesh::certificate {

using Interval = CGAL::Interval_nt<false>;

inline const Interval& enclosure(const Interval& x) { return x; }
inline double width(const Interval& x) { return x.sup() - x.inf(); }
inline double middle(const Interval& x) { return (x.inf() + x.sup()) / 2; }

// The part of x in [lower, upper], which is known to contain the true value. An end that is NaN,
// because an infinite interval was multiplied by 0, says nothing and is replaced.
inline Interval within(double lower, double upper, const Interval& x) {
  const double low = x.inf() > lower ? x.inf() : lower, high = x.sup() < upper ? x.sup() : upper;
  // An empty intersection is impossible; if low were above high, both would be kept in order.
  return {std::min(low, high), std::max(low, high)};
}

// An upper end that is NaN stays so; it is no bound.
inline Interval at_least_zero(const Interval& x) {
  return {x.inf() > 0 ? x.inf() : 0.0, x.sup() <= 0 ? 0.0 : x.sup()};
}

// The root of a number that is known to be at least 0. If s is a root rounded upward, the quotient
// of the number and s, rounded downward, is a lower bound. CGAL's function would change the
// rounding mode twice.
inline Interval root(const Interval& square) {
  const Interval x = at_least_zero(square);
  const double s = std::sqrt(x.inf());
  return {s > 0 ? -(-x.inf() / s) : 0.0, std::sqrt(x.sup())};
}

Interval pi(const Interval&);  // the argument only names the type

// The angle, in [0, π], of the vector (x, y) from the x axis. It is known that y >= 0. If the
// vector may be 0, or is too inaccurate, the result is all of [0, π].
//
// No function of the C library is used. The vector is turned back by the nearest of 65 directions
// (X, Y), whose coordinates are small integers and whose angles are tabulated as intervals: the
// tangent of the remaining angle is z = (y X - x Y) / (x X + y Y), and |z| is at most 1/32 apart
// from rounding. Its arc tangent follows from the series; see the source for the error.
Interval angle(const Interval& y, const Interval& x);

}  // namespace vdwmesh::certificate
