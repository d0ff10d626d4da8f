#include "extract/blended/exponential.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace vdwmesh {
namespace {

// Error bounds of the Taylor remainders and the roundings of the Horner steps, relative.
constexpr double kFloatBound = 4e-7;
constexpr double kDoubleBound = 1e-15;

TEST(Exponential, FloatAgreesWithTheLibraryInLongDouble) {
  for (int i = 0; i <= 200000; ++i) {
    const float x = -86.5f + static_cast<float>(i) * (174.0f / 200000.0f);
    const long double exact = std::exp(static_cast<long double>(x));
    EXPECT_LE(std::abs(static_cast<double>((exponential(x) - exact) / exact)), kFloatBound) << x;
  }
}

TEST(Exponential, DoubleAgreesWithTheLibraryInLongDouble) {
  for (int i = 0; i <= 200000; ++i) {
    const double x = -700 + i * (1400.0 / 200000.0);
    const long double exact = std::exp(static_cast<long double>(x));
    EXPECT_LE(std::abs(static_cast<double>((exponential(x) - exact) / exact)), kDoubleBound) << x;
  }
}

TEST(Exponential, OfZeroIsOneAndFarBelowIsZero) {
  EXPECT_EQ(exponential(0.0f), 1.0f);
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(-1e6f), 0.0f);
  EXPECT_EQ(exponential(-1e30f), 0.0f);
  EXPECT_EQ(exponential(-1e9), 0.0);
}

// The method of the header with std::ldexp() in the place of exponent bits.
float with_ldexp(float x) {
  const float t = std::fmaf(x, 1.44269504f, 12582912.0f), n = t - 12582912.0f;
  const float r = std::fmaf(n, 2.12194440e-4f, std::fmaf(n, -0.693359375f, x));
  float p = std::fmaf(r, 1.0f / 5040, 1.0f / 720);
  for (const float next : {1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f}) {
    p = std::fmaf(r, p, next);
  }
  return std::ldexp(p, static_cast<int>(n));
}

TEST(Exponential, ExponentBitsAreThoseOfTheRoundedQuotient) {
  constexpr int steps = 1 << 20;
  for (int i = 0; i <= steps; ++i) {
    const float x = -87.0f + 175.0f * static_cast<float>(i) / steps;
    ASSERT_EQ(exponential(x), with_ldexp(x)) << x;
  }
}

}  // namespace
}  // namespace vdwmesh
