// What two balls bury of each other's excluded surface, against the closed forms of two balls and
// of the saddle between them; and a pair apart.
#include "interface/excluded_burial.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

SphereSet lone_ball(double z, double radius) { return SphereSet({{{0.3, -0.2, z}, radius}}); }

// Two balls of radius r at a distance d, and a probe p that does not reach the axis between them: a
// torus with the tube p around a circle of radius h, of which the part is seen whose angle at the
// probe goes from the one ball's contact to the other's.
struct Dumbbell {
  double r, d, p;
  double half() const { return 0.5 * d / (r + p); }  // cosine at the ball, sine at the probe
  double circle() const { return std::sqrt((r + p) * (r + p) - 0.25 * d * d); }
  double turn() const { return std::asin(half()); }
  double cap() const { return 2 * kHalfTurn * r * r * (1 - half()); }
  // 2 π p ∫ (h - p cos t) dt for t from -turn to turn.
  double saddle() const { return 4 * kHalfTurn * p * (circle() * turn() - p * std::sin(turn())); }
  // Between the planes of the contact circles: π ∫ (h - p cos t)² p cos t dt.
  double neck() const {
    const double t = turn(), h = circle(), s = std::sin(t), c = std::cos(t);
    return 2 * kHalfTurn * p * (h * h * s - h * p * (t + s * c) + p * p * (s - s * s * s / 3));
  }
  double cap_volume() const {
    const double height = r * (1 - half());
    return kHalfTurn * height * height * (r - height / 3);
  }
};

TEST(ExcludedBurial, TwoBallsAreTheirClosedForms) {
  for (const Dumbbell& w : {Dumbbell{2, 5, 1.4}, Dumbbell{1.7, 3.9, 1.4}, Dumbbell{3, 6.5, 2}}) {
    ASSERT_GT(w.circle(), w.p);
    const ExcludedBurial found = excluded_burial(lone_ball(0, w.r), lone_ball(w.d, w.r), w.p);
    const double ball = 4 * kHalfTurn * w.r * w.r, buried = 2 * w.cap() - w.saddle();
    EXPECT_NEAR(found.area_a, ball, 1e-12 * ball);
    EXPECT_NEAR(found.area_in_pair, 2 * ball - buried, 1e-11 * ball);
    EXPECT_NEAR(found.buried_a, 0.5 * buried, 1e-11 * ball);
    EXPECT_NEAR(found.buried_b, 0.5 * buried, 1e-11 * ball);
    EXPECT_NEAR(found.gap_volume, w.neck() - 2 * w.cap_volume(), 1e-11 * ball);
  }
}

TEST(ExcludedBurial, SidesApartBuryNothing) {
  const ExcludedBurial found = excluded_burial(lone_ball(0, 2), lone_ball(50, 3), 1.4);
  EXPECT_NEAR(found.buried_a, 0, 1e-10);
  EXPECT_NEAR(found.gap_volume, 0, 1e-9);
}

TEST(ExcludedBurial, BadInputIsRefused) {
  EXPECT_THROW(excluded_burial(SphereSet(), lone_ball(0, 1), 1.4), InvalidInput);
  EXPECT_THROW(excluded_burial(lone_ball(0, 1), lone_ball(3, 1), 0), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
