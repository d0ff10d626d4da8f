// Four triangles at a time against the same one by one: those that face outward for certain do so,
// and hardly any others.
#include "refine/crossings/facing_lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "refine/subdivision_formulas.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;

using Corners = std::array<Vec3d, 3>;

// A triangle about a point of the unit sphere around `center`, of some size. Every third one is in
// a plane through the centre, but for rounding, where its side is not clear.
Corners triangle_about(const Vec3d& center, double unit, bool& is_clear, Dice& dice) {
  const auto draw = [&](double size) {
    return Vec3d{dice.real(-size, size), dice.real(-size, size), dice.real(-size, size)};
  };
  const Vec3d at = draw(1);
  Corners p;
  const double size = std::pow(10, dice.real(-8, 0));
  for (Vec3d& corner : p) corner = center + unit * (at + draw(size));
  is_clear = !dice.one_in(3);
  if (!is_clear) {
    const double s = dice.real(-2, 2), t = dice.real(-2, 2);
    p[2] = center + (s * (p[0] - center) + t * (p[1] - center));
  }
  return p;
}

std::uint32_t certain_of(const Vec3d& center, const std::array<Corners, 4>& four) {
  return outward_for_certain(
      center, [&](std::size_t k, std::size_t lane) -> const Vec3d& { return four[lane][k]; });
}

// At 1e-110 areas times lengths are below the least double, and at 1e110 above the largest.
TEST(FacingLanes, WhatIsCertainFacesOutward) {
  Dice dice(1);
  int certain = 0, outward = 0, missed = 0;
  for (const double unit : {1.0, 1e-3, 1e6, 1e-110, 1e110}) {
    for (int round = 0; round < 5000; ++round) {
      const Sphere ball{{unit * dice.real(-50, 50), unit * dice.real(-50, 50), 0}, unit};
      std::array<Corners, 4> four;
      std::array<bool, 4> is_clear;
      for (std::size_t lane = 0; lane < 4; ++lane)
        four[lane] = triangle_about(ball.center, unit, is_clear[lane], dice);
      const std::uint32_t found = certain_of(ball.center, four);
      for (std::size_t lane = 0; lane < 4; ++lane) {
        const std::array<SphereId, 3> atom{0, 0, 0};
        const bool is_outward = facing(&ball, four[lane].data(), atom.data()) == Facing::outward;
        if ((found >> lane & 1) == 0) {
          outward += is_outward;
          missed += is_outward && is_clear[lane] && unit >= 1e-3 && unit <= 1e6;
          continue;
        }
        ASSERT_TRUE(is_outward) << unit << " " << round;
        ++certain;
      }
    }
  }
  EXPECT_GT(certain, 10000);
  EXPECT_GT(outward, 0);              // what is left has some that were not certain,
  EXPECT_LE(1000 * missed, certain);  // hardly any of them off the planes through the centre
}

TEST(FacingLanes, ATriangleOnItsSphereIsCertainInItsLane) {
  const Vec3d a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  const Corners out{a, b, c}, in{a, c, b};
  for (std::uint32_t mask = 0; mask < 16; ++mask) {
    std::array<Corners, 4> four;
    for (std::size_t lane = 0; lane < 4; ++lane) four[lane] = (mask >> lane & 1) != 0 ? out : in;
    EXPECT_EQ(certain_of({0, 0, 0}, four), mask);
  }
}

TEST(FacingLanes, NothingIsCertainOfWhatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = 1e200;
  const Corners out{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Corners broken = out, far = out;
  broken[1].y = nan;
  for (Vec3d& corner : far) corner = huge * corner;
  EXPECT_EQ(certain_of({0, 0, 0}, {out, broken, far, out}), 0b1001u);
}

}  // namespace
}  // namespace vdwmesh
