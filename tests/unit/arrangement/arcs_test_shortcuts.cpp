// Whatever the arcs leave out does not matter: the neighbours that the search does not find and the
// planes beyond every vertex. Each beside the same computation without the shortcut, or beside the
// triangulation, which has none of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "measures/arcs/arcs.hpp"
#include "measures/arcs/cut_ball.hpp"
#include "measures/total_measures.hpp"
#include "reference/closed_forms.hpp"
#include "support/ball_families.hpp"

namespace vdwmesh {
namespace {

using arcs::BallMeasures;
using arcs::Cap;
using testing::BallFamily;
using testing::Dice;
using testing::kBallFamilies;

constexpr unsigned kSetsPerFamily = 30;

template <class Check>
void for_each_set(Check check) {
  for (const BallFamily& family : kBallFamilies) {
    for (unsigned seed = 1; seed <= kSetsPerFamily; ++seed) {
      SCOPED_TRACE(::testing::Message() << family.name << ", seed " << seed);
      Dice dice(seed);
      check(family.make(dice));
      if (::testing::Test::HasFailure()) return;
    }
  }
}

// The caps of ball i from all other balls; none at all, and `buried`, where one of them buries it.
std::vector<Cap> caps_of_all(const std::vector<Sphere>& balls, std::size_t i, bool& buried) {
  std::vector<Cap> caps;
  buried = false;
  for (std::size_t j = 0; j < balls.size(); ++j) {
    const bool equal = balls[j].center == balls[i].center && balls[j].radius == balls[i].radius;
    Cap cap;
    const auto kind = arcs::make_cap(balls[i], balls[j], cap);
    buried = buried || (equal ? j < i : kind == arcs::CapKind::buries);
    if (!equal && kind == arcs::CapKind::cuts) caps.push_back(cap);
  }
  if (buried) caps.clear();
  return caps;
}

BallMeasures measure_whole(std::vector<Cap> caps) { return arcs::CutBall().measure(caps); }

TEST(ArcShortcuts, TheNeighbourSearchFindsEveryCap) {
  for_each_set([](const std::vector<Sphere>& balls) {
    const ArcMeasures found = arc_measures(SphereSet(balls));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      bool buried = false;
      const std::vector<Cap> caps = caps_of_all(balls, i, buried);
      const BallMeasures all = buried ? BallMeasures{} : measure_whole(caps);
      const double r = balls[i].radius;
      ASSERT_EQ(found.per_sphere[i].area, r * r * all.area) << "ball " << i;
      ASSERT_EQ(found.per_sphere[i].volume, r * r * r * all.volume) << "ball " << i;
    }
  });
}

// Cuts with every cap, also those beyond all vertices.
BallMeasures measure_to_the_end(std::vector<Cap> caps) {
  std::sort(caps.begin(), caps.end(), arcs::cuts_deeper);
  arcs::PowerCell cell;
  cell.reset();
  for (std::size_t i = 0; i < caps.size(); ++i) {
    if (i == 0 || !arcs::same_cap(caps[i - 1], caps[i])) cell.cut(caps[i]);
  }
  return arcs::BallMeasurer().measure(cell.finish());
}

TEST(ArcShortcuts, StoppingEarlyLeavesOutNothing) {
  std::size_t closed = 0;
  for_each_set([&](const std::vector<Sphere>& balls) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      bool buried = false;
      const std::vector<Cap> caps = caps_of_all(balls, i, buried);
      if (caps.empty()) continue;
      const BallMeasures early = measure_whole(caps), late = measure_to_the_end(caps);
      ASSERT_EQ(early.area, late.area) << "ball " << i;
      ASSERT_EQ(early.volume, late.volume) << "ball " << i;
      ASSERT_EQ(late.doubts & ~early.doubts & ~arcs::kOnlyCountsInDoubt, 0u) << "ball " << i;
      closed += early.area == 0 && early.volume > 0;
    }
  });
  EXPECT_GT(closed, 500u);  // the stop was there to be tested
}

// What the arcs do not doubt agrees with the triangulation, ball by ball; relative to the ball. A
// doubt is raised when rounding could do more than this.
TEST(ArcShortcuts, EveryBallAgreesWithTheTriangulation) {
  constexpr double kDoubt = 1e-9;
  std::size_t trusted = 0, all = 0;
  for_each_set([&](const std::vector<Sphere>& balls) {
    const ArcMeasures found = arc_measures(SphereSet(balls));
    const ExactUnion exact = exact_union(SphereSet(balls));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      ++all;
      if (std::binary_search(found.suspect.begin(), found.suspect.end(), i)) continue;
      ++trusted;
      const double r = balls[i].radius;
      ASSERT_NEAR(found.per_sphere[i].area, exact.per_sphere[i].area, kDoubt * r * r) << i;
      ASSERT_NEAR(found.per_sphere[i].volume, exact.per_sphere[i].volume, kDoubt * r * r * r) << i;
    }
  });
  EXPECT_GT(trusted, all / 2);
}

// The counts without a triangulation: right or refused.
TEST(ArcShortcuts, CountsAreThoseOfTheTriangulation) {
  std::size_t decided = 0, all = 0;
  for_each_set([&](const std::vector<Sphere>& balls) {
    UnionOptions options;
    options.topology = TopologyRequest::counts;
    const ExactUnion quick = exact_union(SphereSet(balls), options);
    ASSERT_EQ(quick.method, UnionMethod::arcs);
    ASSERT_FALSE(quick.topology.has_value());
    ASSERT_EQ(quick.counts.has_value(), quick.doubtful_spheres == 0);
    ++all;
    if (!quick.counts) return;
    ++decided;
    const ExactUnion exact = exact_union(SphereSet(balls));
    ASSERT_EQ(quick.counts->components, exact.topology->components);
    ASSERT_EQ(quick.counts->euler_characteristic, exact.topology->euler_characteristic);
    ASSERT_EQ(quick.counts->hidden_spheres, exact.topology->hidden_spheres);
  });
  EXPECT_GT(decided, all / 2);
}

// Whether two balls touch, or three circles meet, is not guessed.
TEST(ArcShortcuts, CountsThatRoundingWouldDecideAreRefused) {
  UnionOptions options;
  options.topology = TopologyRequest::counts;
  const auto counts = [&](std::vector<Sphere> balls) {
    return exact_union(SphereSet(std::move(balls)), options).counts;
  };
  for (const double gap : {1e-7, -1e-7}) {
    const auto found = counts({{{0, 0, 0}, 1}, {{2 + gap, 0, 0}, 1}});
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->components, gap > 0 ? 2u : 1u);
    EXPECT_EQ(found->euler_characteristic, gap > 0 ? 4 : 2);
  }
  const auto dust = counts({{{0, 0, 0}, 1e-170}, {{5, 0, 0}, 1}});  // its area in Å² is 0
  ASSERT_TRUE(dust.has_value());
  EXPECT_EQ(dust->hidden_spheres, 0u);
  for (const double gap : {1e-12, 0.0, -1e-12}) {
    EXPECT_FALSE(counts({{{0, 0, 0}, 1}, {{2 + gap, 0, 0}, 1}}).has_value()) << gap;  // outside
    EXPECT_FALSE(counts({{{0, 0, 0}, 2}, {{1 + gap, 0, 0}, 1}}).has_value()) << gap;  // inside
  }
  // The spheres about the corners of a regular tetrahedron meet in its centre, or nearly so; with
  // more gap they enclose a void, or fill it.
  for (const double gap : {1e-12, 0.0, -1e-12, 1e-6, -1e-6}) {
    const double r = std::sqrt(3.0) + gap;
    const auto found =
        counts({{{1, 1, 1}, r}, {{1, -1, -1}, r}, {{-1, 1, -1}, r}, {{-1, -1, 1}, r}});
    ASSERT_EQ(found.has_value(), std::abs(gap) == 1e-6) << gap;
    if (found) {
      EXPECT_EQ(found->euler_characteristic, gap > 0 ? 2 : 4);
    }
  }
}

// Directions spread evenly, along a spiral with golden turns.
Vec3d spiral(int i, int count) {
  const double z = 1 - (2 * i + 1.0) / count, s = std::sqrt(1 - z * z);
  const double turn = std::numbers::pi * (1 + std::sqrt(5.0)) * i;
  return {s * std::cos(turn), s * std::sin(turn), z};
}

// A large ball that overlaps thousands of small ones, which do not meet one another.
TEST(ArcShortcuts, ThousandsOfLensesOnOneBall) {
  constexpr double kRadius = 50, kSmall = 0.7, kDistance = 50.1;
  constexpr int kCount = 4000;
  // Relative. Distances take few values, so roundings do not average out: two units in the last
  // place of 50 Å (7.1e-15 Å) on each radical plane, times both rims, 2 π · 50.7 Å, are 1.8e-8 Å²
  // in all, and a third of the radius times that in volume.
  constexpr double kClosedForm = 5e-13;
  std::vector<Sphere> balls{{{0, 0, 0}, kRadius}};
  for (int i = 0; i < kCount; ++i) balls.push_back({kDistance * spiral(i, kCount), kSmall});
  // Heights of the caps beyond the radical plane, without the difference of the radius and the
  // distance of the plane, which would round all of them alike.
  const double past = kDistance - kRadius;
  const double dent_height = (kSmall - past) * (kSmall + past) / (2 * kDistance);
  const double hidden_height = (kSmall - past) * (kRadius + kDistance - kSmall) / (2 * kDistance);
  const auto large = reference::ball(kRadius), small = reference::ball(kSmall),
             dent = reference::cap(kRadius, dent_height),
             hidden = reference::cap(kSmall, hidden_height);
  const double area = large.area + kCount * (small.area - hidden.area - dent.area);
  const double volume = large.volume + kCount * (small.volume - hidden.volume - dent.volume);
  const ArcMeasures found = arc_measures(SphereSet(balls));
  EXPECT_TRUE(found.suspect.empty());
  const SphereMeasures sum = total_measures(found.per_sphere);
  EXPECT_NEAR(sum.area, area, kClosedForm * area);
  EXPECT_NEAR(sum.volume, volume, kClosedForm * volume);
  const ExactUnion exact = exact_union(SphereSet(balls), {UnionMethod::both});
  EXPECT_NEAR(exact.area, area, kClosedForm * area);
  EXPECT_NEAR(exact.volume, volume, kClosedForm * volume);
  EXPECT_NEAR(*exact.check_area, area, kClosedForm * area);
  EXPECT_NEAR(*exact.check_volume, volume, kClosedForm * volume);
}

}  // namespace
}  // namespace vdwmesh
