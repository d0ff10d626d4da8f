// Orientation and in-circle tests for points of the plane, in double precision with proven error
// bounds (floating-point filters, after Shewchuk 1997, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates"). For host and device.
//
// A test is the sign of a determinant. Each function here returns the sign if rounding cannot have
// changed it, and 0 if it might have. Then the exact tests at the end decide.
//
// Error bounds. u = 2^-53 is the largest relative error of an operation. A product of k factors
// (1 + e) with |e| <= u differs from 1 by at most k u + k² u² (for k <= 11). The bounds below round
// this up to a whole multiple of u, which also covers the rounding of the bound itself. What
// gradual underflow adds is below kUnderflow: a product loses at most 2^-1075, which other factors
// enlarge by at most 2^130 if coordinates are at most kLargestCoordinate.
#pragma once

#include <cmath>

#include "core/host_device.hpp"

namespace vdwmesh {

struct PlanePoint {
  double x, y;
};

// Precondition of all tests: finite coordinates of at most this absolute value. Stereographic
// images of points at least 2^-53 from the pole are smaller.
inline constexpr double kLargestCoordinate = 0x1p60;

namespace plane {

inline constexpr double kRounding = 0x1p-53, kUnderflow = 0x1p-900;

// The sign of a value that differs from the exact one by at most `error`; 0 if that leaves it open.
// It is 0 for NaN as well.
VDWMESH_HD inline int sign_beyond(double value, double error) {
  return value > error ? 1 : (value < -error ? -1 : 0);
}

}  // namespace plane

// Bounds that hold for all points with coordinates up to one absolute value m. They are larger than
// the bounds for the points of one test, but cost nothing in the test.
//
// Differences of coordinates are at most 2 m. So the two products of an orientation add up to at
// most 8 m², and the terms of an in-circle determinant to at most 3 · 8 m² · 8 m². These, times the
// 5 u and 12 u derived below, give 40 u m² and 2304 u m⁴, which are rounded up.
struct PlaneErrors {
  double orientation, in_circle;

  VDWMESH_HD static PlaneErrors up_to(double m) {
    return {48 * plane::kRounding * (m * m) + plane::kUnderflow,
            2560 * plane::kRounding * (m * m) * (m * m) + plane::kUnderflow};
  }
};

// Whether c lies on the left (1) or on the right (-1) of the line from a to b.
//
// Let l and r be the exact products. Each computed product has three roundings (two differences and
// the product), so its error is at most (3 u + 9 u²) times its size; the last difference adds
// u (|l| + |r|). Together that is below 5 u (|l| + |r|), by computed values.
VDWMESH_HD inline int filtered_orientation(const PlaneErrors& errors, const PlanePoint& a,
                                           const PlanePoint& b, const PlanePoint& c) {
  const double l = (a.x - c.x) * (b.y - c.y), r = (a.y - c.y) * (b.x - c.x);
  if (const int sign = plane::sign_beyond(l - r, errors.orientation)) return sign;
  const double error = 5 * plane::kRounding * (std::abs(l) + std::abs(r)) + plane::kUnderflow;
  return plane::sign_beyond(l - r, error);
}

// The parts of the in-circle determinant of a, b, c and d, by cofactors of the lifted points, with
// d as the origin: lift[0] · (product[0] - product[1]) + ...
struct CircleTerms {
  double lift[3], product[6];

  VDWMESH_HD CircleTerms(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                         const PlanePoint& d) {
    const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x,
                 cy = c.y - d.y;
    lift[0] = ax * ax + ay * ay;
    lift[1] = bx * bx + by * by;
    lift[2] = cx * cx + cy * cy;
    product[0] = bx * cy;
    product[1] = cx * by;
    product[2] = cx * ay;
    product[3] = ax * cy;
    product[4] = ax * by;
    product[5] = bx * ay;
  }

  // Positive if d lies inside the circle through a, b and c, which must be counter-clockwise.
  VDWMESH_HD double determinant() const {
    return lift[0] * (product[0] - product[1]) + lift[1] * (product[2] - product[3]) +
           lift[2] * (product[4] - product[5]);
  }

  // The error of the determinant is at most 12 u times the same sum with all terms positive. A lift
  // has four roundings (difference, square, sum; the difference counts twice), a difference of
  // products four, their product one and the two sums two: eleven in a row, so the error is at most
  // (11 u + 121 u²) times the exact sum of absolute values, and that sum exceeds the computed one
  // by at most the same share.
  VDWMESH_HD double error() const {
    const double sum = lift[0] * (std::abs(product[0]) + std::abs(product[1])) +
                       lift[1] * (std::abs(product[2]) + std::abs(product[3])) +
                       lift[2] * (std::abs(product[4]) + std::abs(product[5]));
    return 12 * plane::kRounding * sum + plane::kUnderflow;
  }
};

// The same two tests in exact arithmetic, for what the filters leave undecided. On the host alone.
//
// 1 if c lies on the left of the line from a to b, -1 if on the right, 0 if on the line.
int exact_orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

// For counter-clockwise a, b, c: 1 if d lies inside the circle through them, -1 if outside, 0 if on
// the circle.
int exact_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                    const PlanePoint& d);

}  // namespace vdwmesh
