// sine_cosine() against the C library in extended precision.
#include "creases/sine_cosine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace vdwmesh {
namespace {

// Half a unit in the last place of the largest values, 2^-54, is lost by rounding the sum, and as
// much again at most in the terms before it.
constexpr double kError = 0x1p-52;

void expect_right(double angle) {
  const SineCosine found = sine_cosine(angle);
  const long double exact = angle;
  EXPECT_LE(std::abs(static_cast<double>(found.sine - std::sin(exact))), kError) << angle;
  EXPECT_LE(std::abs(static_cast<double>(found.cosine - std::cos(exact))), kError) << angle;
}

TEST(SineCosine, AsInExtendedPrecision) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> turn(-7, 7), many(-100, 100);
  for (int i = 0; i < 100'000; ++i) {
    expect_right(turn(random));
    expect_right(many(random));
  }
}

// Where quadrants meet, and the signs there.
TEST(SineCosine, AtMultiplesOfAnEighthTurn) {
  const double eighth = std::atan(1.0);
  for (int n = -64; n <= 64; ++n) {
    for (const double towards : {-1e9, 1e9}) expect_right(std::nextafter(n * eighth, towards));
    expect_right(n * eighth);
  }
}

TEST(SineCosine, OfZeroAndTinyAnglesIsExact) {
  for (const double angle : {0.0, 1e-300, -1e-20, 1e-9}) {
    EXPECT_EQ(sine_cosine(angle).sine, angle == 1e-9 ? std::sin(angle) : angle);
    EXPECT_EQ(sine_cosine(angle).cosine, 1.0);
  }
}

}  // namespace
}  // namespace vdwmesh
