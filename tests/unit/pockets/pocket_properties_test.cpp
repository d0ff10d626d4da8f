// Pockets of random sets: volumes against counted points, and what a rotation must not change.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "pockets/pockets.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

std::vector<Sphere> random_balls(unsigned seed, int count, double side) {
  Dice dice(seed);
  std::vector<Sphere> balls;
  for (int i = 0; i < count; ++i) {
    balls.push_back(
        {{dice.real(0, side), dice.real(0, side), dice.real(0, side)}, dice.real(0.8, 2.2)});
  }
  return balls;
}

double total_volume(const std::vector<Pocket>& pockets) {
  double sum = 0;
  for (const Pocket& p : pockets) sum += p.volume;
  return sum;
}

// A rotation by 1 rad about a skew axis (Rodrigues).
Vec3d rotated(const Vec3d& v) {
  const Vec3d axis = 1 / std::sqrt(14.0) * Vec3d{1, 2, 3};
  const double c = std::cos(1.0), s = std::sin(1.0);
  return c * v + s * cross(axis, v) + (1 - c) * dot(axis, v) * axis;
}

// The places for the largest probes and the ways out too. Radii differ much, so summits of the
// clearance are not where the flow ends.
TEST(PocketProperties, RotationChangesNothing) {
  constexpr double kError = 1e-10, kSamePlace = 1e-7;  // a flat summit is known to less
  for (unsigned seed = 1; seed <= 80; ++seed) {
    std::vector<Sphere> balls = random_balls(seed, 120, 12);
    const PocketTable before = pockets(SphereSet(balls));
    for (Sphere& b : balls) b.center = rotated(b.center);
    const PocketTable after = pockets(SphereSet(balls));
    ASSERT_EQ(before.pockets.size(), after.pockets.size()) << seed;
    for (std::size_t i = 0; i < before.pockets.size(); ++i) {
      const Pocket &a = before.pockets[i], &b = after.pockets[i];
      EXPECT_EQ(a.tetrahedra, b.tetrahedra);
      EXPECT_EQ(a.spheres, b.spheres);
      EXPECT_EQ(a.mouths.size(), b.mouths.size());
      EXPECT_NEAR(a.volume, b.volume, kError);
      EXPECT_NEAR(a.area, b.area, kError);
      EXPECT_NEAR(a.volume_sum, b.volume_sum, kError);
      EXPECT_LE(norm(rotated(a.depth_center) - b.depth_center), kError);
      EXPECT_LE(norm(rotated(a.clear_place) - b.clear_place), kSamePlace) << seed;
      EXPECT_NEAR(*a.clearance, *b.clearance, kError) << seed;
      ASSERT_EQ(a.bottleneck_clearance.has_value(), b.bottleneck_clearance.has_value()) << seed;
      if (a.bottleneck_clearance) {
        EXPECT_NEAR(*a.bottleneck_clearance, *b.bottleneck_clearance, kError) << seed;
      }
    }
  }
}

// Both kinds of figures agree for voids, and the parts of areas add up.
TEST(PocketProperties, SumsAreMeasuresOfVoids) {
  constexpr double kError = 1e-11;
  std::size_t voids = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    for (const Pocket& p : pockets(SphereSet(random_balls(seed, 300, 13))).pockets) {
      double lining = 0;
      for (const LiningSphere& s : p.lining) lining += s.area;
      EXPECT_NEAR(lining, p.area, kError);
      EXPECT_GE(p.volume, -kError);
      if (p.kind != PocketKind::enclosed) continue;
      ++voids;
      EXPECT_NEAR(p.volume, p.volume_sum, kError);
      EXPECT_NEAR(p.area, p.area_sum, kError);
    }
  }
  EXPECT_GT(voids, 20u);
}

TEST(PocketProperties, SumsAloneAreTheSameSums) {
  const SphereSet spheres(random_balls(7, 200, 13));
  const PocketTable exact = pockets(spheres);
  const PocketTable sums = pockets(spheres, {.measures = PocketMeasures::sums});
  ASSERT_EQ(exact.pockets.size(), sums.pockets.size());
  EXPECT_NE(total_volume(exact.pockets), total_volume(sums.pockets));
  double a = 0, b = 0;
  for (const Pocket& p : exact.pockets) a += p.volume_sum;
  for (const Pocket& p : sums.pockets) b += p.volume;
  EXPECT_NEAR(a, b, 1e-11);
}

// The order of the spheres, and their distance from the origin, do not matter.
TEST(PocketProperties, OrderDoesNotMatter) {
  std::vector<Sphere> balls = random_balls(3, 150, 12);
  const PocketTable one = pockets(SphereSet(balls));
  std::vector<Sphere> reversed(balls.rbegin(), balls.rend());
  const PocketTable two = pockets(SphereSet(reversed));
  ASSERT_EQ(one.pockets.size(), two.pockets.size());
  for (std::size_t i = 0; i < one.pockets.size(); ++i) {
    EXPECT_EQ(one.pockets[i].volume, two.pockets[i].volume);
    EXPECT_EQ(one.pockets[i].depth_center, two.pockets[i].depth_center);
  }
}

// A lattice is full of ties, which are counted.
TEST(PocketProperties, TiesAreCounted) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) balls.push_back({{3.0 * i, 3.0 * j, 3.0 * k}, 1.6});
    }
  }
  const PocketTable table = pockets(SphereSet(balls));
  EXPECT_GT(table.face_ties, 0u);
  EXPECT_GT(table.cell_ties, 0u);
}

}  // namespace
}  // namespace vdwmesh::testing
