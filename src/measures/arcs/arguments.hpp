// The arguments of complex numbers, some at a time.
//
// The octant of a number and the ratio of its smaller to its larger part say its argument:
// multiples of pi / 2 and the arctangent of the ratio. A ratio t above tan(pi / 8) is replaced by
// (t - 1) / (t + 1), whose arctangent is smaller by pi / 4. There is no branch, and no call of the
// C library, whose digits differ from one version to the next.
#pragma once

#include <cstddef>

#include "core/lanes/lanes.hpp"

namespace vdwmesh::arcs {

// atan(x) = x + x z P(z) with z = x². P is the polynomial of degree 10 that interpolates
// (atan(x) / x - 1) / z in the Chebyshev points of 0 <= z <= tan²(pi / 8); atan(x) / x is then
// right to 6e-18.
VDWMESH_INLINE Lanes arctangent_rest(const Lanes& z) {
  constexpr double kEven[] = {-0.3333333333333333,  -0.14285714284666542, -0.09090904578123903,
                              -0.06664511447381948, -0.0508544973794026,  -0.01917688711906226};
  constexpr double kOdd[] = {0.1999999999999552, 0.11111111015256361, 0.07692183190826087,
                             0.0585814891280221, 0.03923165829558719};
  // Two chains, which the processor computes side by side.
  const Lanes squared = z * z;
  Lanes even = all_lanes(kEven[5]), odd = all_lanes(kOdd[4]);
  for (std::size_t i = 5; i-- > 0;) even = even * squared + kEven[i];
  for (std::size_t i = 4; i-- > 0;) odd = odd * squared + kOdd[i];
  return even + z * odd;
}

// In [0, 2 pi), to a few units in the last place. NaN for 0. Precondition: the larger part is
// neither too large nor too small for its double and its half.
VDWMESH_INLINE Lanes arguments(const Lanes& re, const Lanes& im) {
  constexpr double kTangent = 0.41421356237309503;  // of pi / 8
  // pi / 4 and what this double leaves out of it.
  constexpr double kQuarter = 0.7853981633974483, kRest = 3.061616997868383e-17;
  const Lanes width = re < 0 ? -re : re, height = im < 0 ? -im : im, none{};
  const LaneBits is_steep = height > width;
  const Lanes smaller = is_steep ? width : height, larger = is_steep ? height : width;
  const LaneBits is_wide = smaller > kTangent * larger;
  const Lanes x = (is_wide ? smaller - larger : smaller) / (is_wide ? smaller + larger : larger),
              z = x * x, rest = is_wide ? all_lanes(kRest) : none;
  Lanes angle = (x + (x * z * arctangent_rest(z) + rest)) + (is_wide ? all_lanes(kQuarter) : none);
  angle = is_steep ? (2 * kQuarter - angle) + 2 * kRest : angle;
  angle = re < 0 ? (4 * kQuarter - angle) + 4 * kRest : angle;
  return im < 0 ? (8 * kQuarter - angle) + 8 * kRest : angle;
}

}  // namespace vdwmesh::arcs
