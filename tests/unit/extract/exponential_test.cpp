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

}  // namespace
}  // namespace vdwmesh
