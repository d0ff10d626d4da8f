// The exact union against closed forms and known topology, tangency and nesting included.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/errors.hpp"
#include "reference/closed_forms.hpp"
#include "union_cases.hpp"

namespace vdwmesh {
namespace {

using testing::buckminsterfullerene;
using testing::cubic_lattice;
using testing::unite;

constexpr double kPi = std::numbers::pi;
// Relative: a few hundred roundings of 1.1e-16 on numbers of the size of the result.
constexpr double kClosedForm = 1e-13;

void expect_measures(const ExactUnion& u, double area, double volume) {
  EXPECT_RELATIVE(u.area, area, kClosedForm);
  EXPECT_RELATIVE(u.volume, volume, kClosedForm);
  EXPECT_RELATIVE(*u.check_area, area, kClosedForm);
  EXPECT_RELATIVE(*u.check_volume, volume, kClosedForm);
}

void expect_betti(const ExactUnion& u, std::uint64_t components, std::uint64_t tunnels,
                  std::uint64_t voids) {
  const UnionTopology& t = *u.topology;
  EXPECT_EQ(t.components, components);
  EXPECT_EQ(t.tunnels, tunnels);
  EXPECT_EQ(t.voids, voids);
  EXPECT_EQ(t.euler_characteristic, 2 * (static_cast<std::int64_t>(components + voids) -
                                         static_cast<std::int64_t>(tunnels)));
}

TEST(UnionClosedForms, EmptySetIsRefused) {
  for (const auto method : {UnionMethod::cgal, UnionMethod::arcs, UnionMethod::both}) {
    EXPECT_THROW(unite({}, method), InvalidInput);
  }
}

TEST(UnionClosedForms, OneBall) {
  const ExactUnion u = unite({{{1, -2, 3}, 1.7}});
  const auto expected = reference::ball(1.7);
  expect_measures(u, expected.area, expected.volume);
  expect_betti(u, 1, 0, 0);
  ASSERT_EQ(u.topology->shells.size(), 1u);
  EXPECT_RELATIVE(u.topology->shells[0].volume, expected.volume, kClosedForm);
}

TEST(UnionClosedForms, TwoBalls) {
  for (const double d : {0.0, 0.25, 0.5, 0.75, 1.5, 2.5, 2.75, 3.5}) {  // nested … lens … apart
    const ExactUnion u = unite({{{0, 0, 0}, 1.5}, {{0, d, 0}, 1.0}});
    const auto expected = reference::two_balls(1.5, 1.0, d);
    expect_measures(u, expected.area, expected.volume);
    expect_betti(u, d > 2.5 ? 2 : 1, 0, 0);
    EXPECT_EQ(u.topology->point_contacts, d == 2.5 ? 1u : 0u);
    EXPECT_EQ(u.topology->hidden_spheres, d <= 0.5 ? 1u : 0u);
    EXPECT_EQ(u.topology->shells.size(), d > 2.5 ? 2u : 1u);
  }
}

// Equal balls nearer to one another than the square root of the least double, and two that cut
// them: to rounding, one ball and two lenses.
TEST(UnionClosedForms, CentresNextToNothingApart) {
  const auto one = reference::ball(1), lens = reference::two_balls(1, 0.5, 1.2);
  for (const double apart : {1e-20, 1e-32, 1e-100, 1e-150, 1e-170, 1e-300}) {
    SCOPED_TRACE(apart);
    const Sphere left{{-1.2, 0, 0}, 0.5}, up{{0, 1.2, 0}, 0.5};
    std::vector<Sphere> balls{{{0, 0, 0}, 1}, {{apart, 0, 0}, 1}};
    expect_measures(unite(balls), one.area, one.volume);
    expect_measures(unite(balls, UnionMethod::both), one.area, one.volume);
    balls.insert(balls.end(), {left, up});
    expect_measures(unite(balls), 2 * lens.area - one.area, 2 * lens.volume - one.volume);
    expect_measures(unite(balls, UnionMethod::both), 2 * lens.area - one.area,
                    2 * lens.volume - one.volume);
    balls.insert(balls.end(), {{{0, apart, 0}, 1}, {{0, 0, -apart}, 1}});
    const ExactUnion u = unite(balls);
    expect_measures(u, 2 * lens.area - one.area, 2 * lens.volume - one.volume);
    expect_betti(u, 1, 0, 0);
  }
}

TEST(UnionClosedForms, MeasuresThatNoDoubleHoldsAreRefused) {
  for (const auto method : {UnionMethod::cgal, UnionMethod::arcs, UnionMethod::both}) {
    EXPECT_THROW(unite({{{0, 0, 0}, 1e200}}, method), InvalidInput);
  }
}

TEST(UnionClosedForms, BallsWithoutExposedAreaHaveNone) {
  // Inside touching from within, inside apart, concentric, and a duplicate: the first owns.
  const ExactUnion u = unite(
      {{{0, 0, 0}, 2.0}, {{1, 0, 0}, 1.0}, {{0.5, 0, 0}, 1.0}, {{0, 0, 0}, 1.5}, {{0, 0, 0}, 2.0}});
  const auto expected = reference::ball(2);
  expect_measures(u, expected.area, expected.volume);
  EXPECT_RELATIVE(u.per_sphere[0].area, expected.area, kClosedForm);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(u.per_sphere[i].area, 0);
  EXPECT_EQ(u.topology->hidden_spheres, 4u);
  EXPECT_EQ(u.topology->point_contacts, 0u);
  expect_betti(u, 1, 0, 0);
}

TEST(UnionClosedForms, ThreeTangentBallsInARing) {
  // Sides 3, 4, 5: the tangencies are exact in double.
  const ExactUnion u = unite({{{0, 0, 0}, 1}, {{3, 0, 0}, 2}, {{0, 4, 0}, 3}});
  expect_measures(u, 4 * kPi * 14, 4 * kPi / 3 * 36);
  expect_betti(u, 1, 1, 0);
  EXPECT_EQ(u.topology->point_contacts, 3u);
  EXPECT_EQ(u.topology->shells.size(), 1u);
}

TEST(UnionClosedForms, Chains) {
  for (const double spacing : {1.0, 0.75}) {  // tangent, overlapping
    std::vector<Sphere> balls;
    for (int i = 0; i < 9; ++i) balls.push_back({{spacing * i, 0, 0}, 0.5});
    const auto one = reference::ball(0.5);
    const auto cap = reference::cap(0.5, 0.5 - spacing / 2);
    const ExactUnion u = unite(balls);
    expect_measures(u, 9 * one.area - 16 * cap.area, 9 * one.volume - 16 * cap.volume);
    expect_betti(u, 1, 0, 0);
    EXPECT_EQ(u.topology->point_contacts, spacing == 1.0 ? 8u : 0u);
  }
}

TEST(UnionClosedForms, RingOfOverlappingBalls) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 12; ++i) {
    const double t = 2 * kPi * i / 12;
    balls.push_back({{4 * std::cos(t), 4 * std::sin(t), 0}, 1.2});
  }
  const auto expected = reference::ring_of_balls(12, 4, 1.2);
  const ExactUnion u = unite(balls);
  expect_measures(u, expected.area, expected.volume);
  expect_betti(u, 1, 1, 0);
}

TEST(UnionClosedForms, CubicLatticeOfTangentBalls) {
  const ExactUnion u = unite(cubic_lattice(5, 1, 0.5));
  expect_measures(u, 125 * 4 * kPi * 0.25, 125 * 4 * kPi / 3 * 0.125);
  expect_betti(u, 1, 176, 0);  // 125 balls, 300 contacts
  EXPECT_EQ(u.topology->point_contacts, 300u);
}

TEST(UnionClosedForms, LatticeOfLenses) {
  // Radius 1 and spacing 1.5: neighbours overlap in a lens, no three balls meet.
  const ExactUnion u = unite(cubic_lattice(6, 1.5, 1));
  const auto lens = reference::two_balls(1, 1, 1.5);
  const auto one = reference::ball(1);
  expect_measures(u, 540 * lens.area - 864 * one.area, 540 * lens.volume - 864 * one.volume);
  EXPECT_RELATIVE(u.area, 1017.87601976, 1e-11);  // as published with the reference sets
  EXPECT_RELATIVE(u.volume, 710.39263879, 1e-11);
  expect_betti(u, 1, 325, 0);
  EXPECT_EQ(u.topology->euler_characteristic, -648);
}

TEST(UnionClosedForms, LatticeFilledByBallsThroughOnePoint) {
  // Cells of 2 x 2 x 1: the eight corners are 1.5 from the centre, exactly, so that eight balls of
  // that radius meet there and leave no void.
  std::vector<Sphere> balls;
  for (int z = 0; z < 3; ++z) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 3; ++x) balls.push_back({{2.0 * x, 2.0 * y, 1.0 * z}, 1.5});
    }
  }
  const ExactUnion u = unite(balls);
  expect_betti(u, 1, 0, 0);
  EXPECT_RELATIVE(*u.check_area, u.area, kClosedForm);
  EXPECT_RELATIVE(*u.check_volume, u.volume, kClosedForm);
}

TEST(UnionClosedForms, BallsThroughOnePointCloseTheVoid) {
  // The 24 points (±1, ±2, ±2) in all orders are 3 away from the origin.
  std::vector<Sphere> balls;
  for (int one = 0; one < 3; ++one) {
    for (int signs = 0; signs < 8; ++signs) {
      Sphere s{{0, 0, 0}, 3};
      for (int k = 0; k < 3; ++k) s.center[k] = (k == one ? 1 : 2) * ((signs >> k) & 1 ? -1 : 1);
      balls.push_back(s);
    }
  }
  expect_betti(unite(balls), 1, 0, 0);
  for (Sphere& s : balls) s.radius = std::nextafter(3.0, 0.0);
  expect_betti(unite(balls), 1, 0, 1);
}

TEST(UnionClosedForms, CageOfC60) {
  const ExactUnion u = unite(buckminsterfullerene(1.42, 1.7));
  expect_betti(u, 1, 0, 1);
  EXPECT_EQ(u.topology->euler_characteristic, 4);
  ASSERT_EQ(u.topology->shells.size(), 2u);
  const Shell outer = u.topology->shells[0], inner = u.topology->shells[1];
  EXPECT_GT(outer.volume, 0);
  EXPECT_LT(inner.volume, 0);
  EXPECT_RELATIVE(outer.area + inner.area, u.area, kClosedForm);
  EXPECT_RELATIVE(outer.volume + inner.volume, u.volume, kClosedForm);
  EXPECT_RELATIVE(u.topology->void_volume, -inner.volume, kClosedForm);
  // The ball about the centre that touches every atom lies in the void.
  const double cage = std::sqrt(squared_norm(buckminsterfullerene(1.42, 1.7)[0].center));
  const double r = cage - 1.7;
  EXPECT_GT(-inner.volume, 4 * kPi / 3 * r * r * r);
  ASSERT_EQ(u.topology->void_table.size(), 1u);
  const Void& v = u.topology->void_table[0];
  EXPECT_RELATIVE(v.volume, -inner.volume, kClosedForm);
  EXPECT_RELATIVE(v.area, inner.area, kClosedForm);
  EXPECT_LT(norm(v.center), 1e-10);
  EXPECT_NEAR(v.clearance, r, 1e-10);
  EXPECT_EQ(v.lining.size(), 60u);
}

// Outer surfaces come first and voids last, each with the larger before the smaller, wherever they
// lie.
TEST(UnionClosedForms, ShellsOfCagesByFallingVolume) {
  for (const double side : {-20.0, 20.0}) {
    std::vector<Sphere> balls = buckminsterfullerene(1.42, 1.7);
    const ExactUnion small = unite(balls), large = unite(buckminsterfullerene(1.6, 1.7));
    for (Sphere s : buckminsterfullerene(1.6, 1.7)) {
      s.center.x += side;
      balls.push_back(s);
    }
    const ExactUnion u = unite(balls);
    const std::vector<Shell>& shells = u.topology->shells;
    ASSERT_EQ(shells.size(), 4u);
    constexpr double kMoved = 1e-12;  // relative: coordinates are rounded by the shift
    EXPECT_RELATIVE(shells[0].volume, large.topology->shells[0].volume, kMoved);
    EXPECT_RELATIVE(shells[1].volume, small.topology->shells[0].volume, kMoved);
    EXPECT_RELATIVE(shells[2].volume, large.topology->shells[1].volume, kMoved);
    EXPECT_RELATIVE(shells[3].volume, small.topology->shells[1].volume, kMoved);
    EXPECT_GT(-shells[2].volume, -shells[3].volume);
  }
}

TEST(UnionClosedForms, IslandInAVoid) {
  std::vector<Sphere> balls;
  for (const Sphere& s : cubic_lattice(3, 1, 0.9)) {
    if (squared_norm(s.center - Vec3d{1, 1, 1}) > 0) balls.push_back(s);
  }
  const ExactUnion hollow = unite(balls);
  expect_betti(hollow, 1, 0, 1);
  balls.push_back({{1, 1, 1}, 0.0625});
  const ExactUnion u = unite(balls);
  const auto island = reference::ball(0.0625);
  expect_betti(u, 2, 0, 1);
  ASSERT_EQ(u.topology->shells.size(), 3u);
  EXPECT_RELATIVE(u.topology->shells[0].volume, hollow.topology->shells[0].volume, kClosedForm);
  EXPECT_RELATIVE(u.topology->shells[1].volume, island.volume, kClosedForm);
  EXPECT_RELATIVE(u.topology->shells[1].area, island.area, kClosedForm);
  // Å³ of the void, a hundredth of the volumes it is the difference of.
  constexpr double kVoid = 1e-11;
  EXPECT_RELATIVE(u.topology->shells[2].volume, hollow.topology->shells[1].volume, kVoid);
  EXPECT_RELATIVE(u.topology->void_volume, hollow.topology->void_volume - island.volume, kVoid);
  ASSERT_EQ(u.topology->void_table.size(), 1u);
  const Void& v = u.topology->void_table[0];
  EXPECT_RELATIVE(v.volume, u.topology->void_volume, kVoid);
  EXPECT_RELATIVE(v.area, hollow.topology->void_area + island.area, kVoid);
  EXPECT_EQ(v.lining.back(), 26u);
}

TEST(UnionClosedForms, MonteCarloVolume) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> place(0, 6), radius(0.5, 1.5);
  std::vector<Sphere> balls(60);
  for (Sphere& s : balls) s = {{place(random), place(random), place(random)}, radius(random)};
  std::uniform_real_distribution<double> probe(-1.5, 7.5);
  constexpr int kSamples = 200000;
  int inside = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vec3d p{probe(random), probe(random), probe(random)};
    inside += std::any_of(balls.begin(), balls.end(), [&](const Sphere& s) {
      return squared_norm(p - s.center) <= s.radius * s.radius;
    });
  }
  const double share = static_cast<double>(inside) / kSamples, box = 9.0 * 9 * 9;
  const double error = box * std::sqrt(share * (1 - share) / kSamples);
  EXPECT_NEAR(unite(balls).volume, box * share, 5 * error);
}

}  // namespace
}  // namespace vdwmesh
