// Sine and cosine, for host and device, with the same bits on both and on every version of the C
// library. Arc tangents, and the sines of other files, are still those of the C library.
//
// The nearest multiple n of pi / 2 is taken off the angle, in two steps with fused multiply-adds;
// then Taylor's series are summed for |x| <= pi / 4. The first terms left out are x^19 / 19! <
// 9e-20 and x^18 / 18! < 3e-18, far below the rounding of a double.
#pragma once

#include <cmath>

#include "core/host_device.hpp"

namespace vdwmesh {

struct SineCosine {
  double sine, cosine;
};

// Of an angle in radians, to two units in the last place of 1. Precondition: |angle| <= 100, so
// that n has few bits and the products below are exact enough.
VDWMESH_HD inline SineCosine sine_cosine(double angle) {
  // pi / 2 and what this double leaves out of it.
  constexpr double kQuarter = 1.5707963267948966, kRest = 6.123233995736766e-17;
  const double n = std::floor(angle / kQuarter + 0.5);
  const double x = std::fma(-n, kRest, std::fma(-n, kQuarter, angle)), z = x * x;
  double sine = 1.0 / 355687428096000;  // 17!
  sine = sine * z - 1.0 / 1307674368000;
  sine = sine * z + 1.0 / 6227020800;
  sine = sine * z - 1.0 / 39916800;
  sine = sine * z + 1.0 / 362880;
  sine = sine * z - 1.0 / 5040;
  sine = sine * z + 1.0 / 120;
  sine = sine * z - 1.0 / 6;
  sine = x + x * (z * sine);
  double cosine = 1.0 / 20922789888000;  // 16!
  cosine = cosine * z - 1.0 / 87178291200;
  cosine = cosine * z + 1.0 / 479001600;
  cosine = cosine * z - 1.0 / 3628800;
  cosine = cosine * z + 1.0 / 40320;
  cosine = cosine * z - 1.0 / 720;
  cosine = cosine * z + 1.0 / 24;
  // 1 - z / 2 is rounded, and what that lost is added to the rest of the series.
  const double half = 0.5 * z, near = 1 - half;
  cosine = near + (((1 - near) - half) + z * (z * cosine));
  const int quadrant = static_cast<int>(n - 4 * std::floor(n / 4));
  if (quadrant == 0) return {sine, cosine};
  if (quadrant == 1) return {cosine, -sine};
  if (quadrant == 2) return {-sine, -cosine};
  return {-cosine, sine};
}

}  // namespace vdwmesh
