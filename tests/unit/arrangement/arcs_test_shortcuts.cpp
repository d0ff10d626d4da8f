// Whatever the arcs leave out does not matter: the neighbours that the search does not find, the
// caps that come after the cell is closed, the caps that do not reach a sector, the methods of the
// kernel that look at touched faces alone. Each beside the same computation without the shortcut,
// or beside the triangulation, which has none of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/arcs/arc_sectors.hpp"
#include "arrangement/arcs/arcs.hpp"
#include "ball_families.hpp"
#include "reference/closed_forms.hpp"

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

BallMeasures measure_whole(std::vector<Cap> caps) {
  arcs::CellSpace space;
  return arcs::measure_ball(caps.data(), static_cast<std::uint32_t>(caps.size()),
                            space.reserve(caps.size(), caps.size()));
}

TEST(ArcShortcuts, TheNeighbourSearchFindsEveryCap) {
  for_each_set([](const std::vector<Sphere>& balls) {
    const ArcMeasures found = arc_measures(SphereSet(balls));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      bool buried = false;
      const std::vector<Cap> caps = caps_of_all(balls, i, buried);
      const BallMeasures all = buried ? BallMeasures{0, 0, 0} : measure_whole(caps);
      const double r = balls[i].radius;
      ASSERT_EQ(found.per_sphere[i].area, r * r * all.area) << "ball " << i;
      ASSERT_EQ(found.per_sphere[i].volume, r * r * r * all.volume) << "ball " << i;
    }
  });
}

// Cuts with every cap, also after the cell is closed or empty.
BallMeasures measure_to_the_end(const std::vector<Cap>& caps) {
  const auto count = static_cast<std::uint32_t>(caps.size());
  arcs::CellSpace space;
  arcs::BallCell cell(space.reserve(caps.size(), caps.size()), arcs::EdgeEnding::direct);
  std::uint32_t doubts = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!arcs::repeats_plane(caps.data(), i, doubts)) cell.cut(caps[i]);
  }
  return arcs::measure_cell(cell, caps.data(), count);
}

TEST(ArcShortcuts, StoppingEarlyLeavesOutNothing) {
  std::size_t closed = 0;
  for_each_set([&](const std::vector<Sphere>& balls) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      bool buried = false;
      std::vector<Cap> caps = caps_of_all(balls, i, buried);
      if (caps.empty()) continue;
      const auto count = static_cast<std::uint32_t>(caps.size());
      std::sort(caps.begin(), caps.end(), arcs::cuts_deeper);
      arcs::CellSpace space;
      const BallMeasures early = arcs::measure_sorted(
          caps.data(), count, space.reserve(count, count), arcs::EdgeEnding::direct);
      const BallMeasures late = measure_to_the_end(caps);
      ASSERT_EQ(early.area, late.area) << "ball " << i;
      ASSERT_EQ(early.volume, late.volume) << "ball " << i;
      ASSERT_EQ(late.doubts & ~early.doubts, 0u) << "ball " << i;  // none was missed
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

std::vector<Cap> random_caps(Dice& dice) {
  std::vector<Cap> caps(static_cast<std::size_t>(dice.whole(1, 400)));
  const double smallest = dice.real(0.02, 0.5), spread = dice.real(1, 3);
  for (Cap& cap : caps) {
    cap = {testing::random_direction(dice), std::cos(smallest * dice.real(1, spread))};
  }
  std::sort(caps.begin(), caps.end(), arcs::cuts_deeper);
  return caps;
}

// Forced into sectors of a few caps, and as one piece.
TEST(ArcShortcuts, SectorsAddUpToTheBall) {
  // Some 400 sectors, each with a few dozen roundings of numbers up to 4 π.
  constexpr double kRounding = 1e-12;
  std::size_t compared = 0;
  for (unsigned seed = 1; seed <= 300; ++seed) {
    Dice dice(seed);
    const std::vector<Cap> caps = random_caps(dice);
    const BallMeasures whole = measure_whole(caps);
    const BallMeasures parts =
        arcs::measure_by_sectors(caps, static_cast<std::size_t>(dice.whole(3, 40)));
    if (whole.doubts || parts.doubts) continue;
    ++compared;
    EXPECT_NEAR(parts.area, whole.area, kRounding) << seed;
    EXPECT_NEAR(parts.volume, whole.volume, kRounding) << seed;
  }
  EXPECT_GT(compared, 250u);
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
  EXPECT_NEAR(found.area, area, kClosedForm * area);
  EXPECT_NEAR(found.volume, volume, kClosedForm * volume);
  const ExactUnion exact = exact_union(SphereSet(balls));
  EXPECT_NEAR(exact.area, area, kClosedForm * area);
  EXPECT_NEAR(exact.volume, volume, kClosedForm * volume);
  EXPECT_NEAR(*exact.check_area, area, kClosedForm * area);
  EXPECT_NEAR(*exact.check_volume, volume, kClosedForm * volume);
}

}  // namespace
}  // namespace vdwmesh
