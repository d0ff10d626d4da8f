// The exponential function with the same bits on host and device. Library functions differ between
// the two; here every operation is written out and rounds the same everywhere.
//
// Method: x = n ln 2 + r with an integer n and |r| <= ln(2) / 2 (Cody-Waite reduction), so that e^x
// = 2^n e^r. A Taylor polynomial gives e^r, and 2^n is built from its exponent bits.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"

namespace vdwmesh {

// Returns e^x with a relative error below 3e-7 for x from -87 to 88, and 0 for x < -87.
// Precondition: x <= 88, so that 2^n is finite. The Taylor polynomial goes to r^7.
VDWMESH_HD inline float exponential(float x) {
  // 1.5 * 2^23. Floats of this size are integers, so adding this constant rounds x / ln 2 to the
  // nearest integer, and subtracting it again gives that integer, n.
  constexpr float round_to_integer = 12582912.0f;
  const float t = std::fmaf(x, 1.44269504f, round_to_integer);
  const float n = t - round_to_integer;
  // n ln 2 is subtracted in two parts, because ln 2 as one float32 is not precise enough. The first
  // part of ln 2 has so few digits that n times it is exact.
  float r = std::fmaf(n, -0.693359375f, x);
  r = std::fmaf(n, 2.12194440e-4f, r);
  float p = std::fmaf(r, 1.0f / 5040, 1.0f / 720);
  p = std::fmaf(r, p, 1.0f / 120);
  p = std::fmaf(r, p, 1.0f / 24);
  p = std::fmaf(r, p, 1.0f / 6);
  p = std::fmaf(r, p, 0.5f);
  p = std::fmaf(r, p, 1.0f);
  p = std::fmaf(r, p, 1.0f);
  // The exponent field of the float 2^n is n + 127, at least 1 for x >= -87. The low bits of t are
  // n modulo 2^22, since t is the constant plus n and the last place of such floats is 1: moved to
  // the exponent field, they need no conversion of n. For smaller x the result is 0 whatever the
  // field is.
  const float scale =
      std::bit_cast<float>((std::bit_cast<std::uint32_t>(t) << 23) + (std::uint32_t{127} << 23));
  return x < -87.0f ? 0.0f : p * scale;
}

// The same method in double: returns e^x with a relative error below 1e-15 for x from -708 to 709,
// and 0 for x < -708. Precondition: x <= 709. The Taylor polynomial goes to r^13. Here the scale is
// made from the integer n, which is not below -1022, so that its exponent field is at least 1.
VDWMESH_HD inline double exponential(double x) {
  constexpr double round_to_integer = 6755399441055744.0;  // 1.5 * 2^52
  const double t = std::fma(x, 1.4426950408889634074, round_to_integer);
  const double n = t - round_to_integer;
  double r = std::fma(n, -6.93147180369123816490e-01, x);
  r = std::fma(n, -1.90821492927058770002e-10, r);
  double p = std::fma(r, 1.0 / 6227020800.0, 1.0 / 479001600.0);
  p = std::fma(r, p, 1.0 / 39916800.0);
  p = std::fma(r, p, 1.0 / 3628800.0);
  p = std::fma(r, p, 1.0 / 362880.0);
  p = std::fma(r, p, 1.0 / 40320.0);
  p = std::fma(r, p, 1.0 / 5040.0);
  p = std::fma(r, p, 1.0 / 720.0);
  p = std::fma(r, p, 1.0 / 120.0);
  p = std::fma(r, p, 1.0 / 24.0);
  p = std::fma(r, p, 1.0 / 6.0);
  p = std::fma(r, p, 0.5);
  p = std::fma(r, p, 1.0);
  p = std::fma(r, p, 1.0);
  const double clamped = n < -1022.0 ? -1022.0 : n;
  const double scale =
      std::bit_cast<double>((static_cast<std::int64_t>(clamped) + 1023) * (std::int64_t{1} << 52));
  return x < -708.0 ? 0.0 : p * scale;
}

}  // namespace vdwmesh
