// Nearest points on spheres, circles and corners, against places known from elementary geometry.
#include "refine/sphere_formulas.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace vdwmesh {
namespace {

// A few roundings of numbers of order 1.
constexpr double kRounding = 1e-14;  // Å

void expect_at(const FoundPoint& point, const Vec3d& exact) {
  ASSERT_TRUE(point.found);
  EXPECT_LE(norm(point.position - exact), kRounding)
      << point.position.x << " " << point.position.y << " " << point.position.z;
}

TEST(NearestOnSphere, IsOnTheRay) {
  const Sphere s{{1, 2, 3}, 5};
  expect_at(nearest_on_sphere(s, {4, 2, 7}), {4, 2, 7});
  expect_at(nearest_on_sphere(s, {2.5, 2, 5}), {4, 2, 7});
  expect_at(nearest_on_sphere(s, {1, -98, 3}), {1, -3, 3});
  EXPECT_FALSE(nearest_on_sphere(s, s.center).found);
}

TEST(NearestOnCircle, OfEqualSpheresIsInTheMiddlePlane) {
  // 3-4-5: spheres of radius 5 around (-3, 0, 0) and (3, 0, 0) meet in the circle of radius 4.
  const Sphere a{{-3, 0, 0}, 5}, b{{3, 0, 0}, 5};
  expect_at(nearest_on_circle(a, b, {1, 2, 0}), {0, 4, 0});
  expect_at(nearest_on_circle(b, a, {-7, 0, -0.5}), {0, 0, -4});
  EXPECT_FALSE(nearest_on_circle(a, b, {1, 0, 0}).found);  // on the axis
}

TEST(NearestOnCircle, OfUnequalSpheresIsInTheirRadicalPlane) {
  // 5-12-13 and 9-12-15: radii 13 and 15, centres 14 apart, circle of radius 12 at 5 from the
  // first.
  const Sphere a{{0, 0, 0}, 13}, b{{0, 0, 14}, 15};
  expect_at(nearest_on_circle(a, b, {3, 4, 2}), {7.2, 9.6, 5});
}

TEST(NearestOnCircle, IsNotFoundWhereSpheresDoNotCross) {
  const Sphere a{{0, 0, 0}, 1};
  EXPECT_FALSE(nearest_on_circle(a, {{3, 0, 0}, 1}, {1, 1, 0}).found);    // apart
  EXPECT_FALSE(nearest_on_circle(a, {{0.1, 0, 0}, 3}, {1, 1, 0}).found);  // nested
  EXPECT_FALSE(nearest_on_circle(a, a, {1, 1, 0}).found);                 // coincident
  EXPECT_FALSE(nearest_on_circle(a, {{0, 0, 0}, 2}, {1, 1, 0}).found);    // concentric
}

TEST(NearestCorner, TakesTheSideOfThePoint) {
  // Centres on the unit circle's axes in the plane z = 0, radii sqrt(2): all pass (0, 0, ±1).
  const double r = std::sqrt(2.0);
  const Sphere a{{1, 0, 0}, r}, b{{-1, 0, 0}, r}, c{{0, 1, 0}, r};
  expect_at(nearest_corner(a, b, c, {0.1, 0.2, 0.3}), {0, 0, 1});
  expect_at(nearest_corner(b, c, a, {0.1, 0.2, -0.3}), {0, 0, -1});
}

TEST(NearestCorner, IsNotFoundWithoutACommonPoint) {
  const Sphere a{{0, 0, 0}, 1}, b{{1, 0, 0}, 1};
  EXPECT_FALSE(nearest_corner(a, b, {{2, 0, 0}, 1}, {0, 0, 1}).found);    // centres in a row
  EXPECT_FALSE(nearest_corner(a, b, {{0.5, 5, 0}, 1}, {0, 0, 1}).found);  // too far
}

TEST(NearestBall, IsOfLeastGapAndTiesGoToTheLowestRank) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 5; ++i) balls.push_back({{2.0 * i, 0, 0}, 1.5});
  balls.push_back(balls[3]);
  const SphereSet spheres(balls);
  const CellList list = make_ball_list(spheres);
  for (double x = -2; x < 10; x += 0.125) {
    const Vec3d p{x, 0.5, 0.25};
    const NearestBall best = nearest_ball(list.view(), p, 1e-9, 5);
    ASSERT_TRUE(best.found);
    // All squares are exact, so the nearest centre along x is the nearest ball; halfway between two
    // it is the lower one, and of the two equal balls the first.
    const auto expected = static_cast<SphereId>(std::clamp(std::ceil(x / 2 - 0.5), 0.0, 4.0));
    const double dx = x - 2.0 * expected;
    EXPECT_EQ(list.view().id[best.place], expected) << x;
    EXPECT_NEAR(best.gap, std::sqrt(dx * dx + 0.25 + 0.0625) - 1.5, kRounding);
  }
  EXPECT_FALSE(nearest_ball(list.view(), {4, 20, 0}, 1e-9, 5).found);
}

}  // namespace
}  // namespace vdwmesh
