// The arrangement that the crease-exact mesher makes, against the measures from arcs, which have
// nothing but the balls in common with it: areas, and the Euler characteristic of each patch. And
// the order of the balls.
#include "creases/arcs/arrangement.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "core/errors.hpp"
#include "measures/arcs/arcs.hpp"
#include "support/family_sets.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

// Three arcs end in each corner, and the areas are those from arcs, but for balls that these have
// doubts about.
void expect_sound(const std::vector<Sphere>& balls) {
  const SphereSet spheres(balls);
  const Arrangement found = arrange(spheres);
  std::vector<int> ends(found.boundary.corners.size(), 0);
  for (const CornerArc& arc : found.boundary.arcs) {
    for (const std::uint32_t corner : arc.corners) {
      if (!arc.is_circle()) ++ends.at(corner);
    }
  }
  EXPECT_TRUE(std::ranges::all_of(ends, [](int n) { return n == 3; }));
  EXPECT_TRUE(std::ranges::is_sorted(found.boundary.corners));
  EXPECT_TRUE(std::ranges::is_sorted(found.boundary.arcs));
  const ArcMeasures arcs = arc_measures(spheres);
  // Areas of balls of which nothing is in doubt are wrong by up to 1e-9 of the squared radius for
  // each of their corners (arcs::kMaxError), of which there are at most some hundred.
  constexpr double kAreaError = 1e-6;
  double largest = 0;
  for (const Sphere& s : balls) largest = std::max(largest, s.radius);
  const double rounding = largest * std::numeric_limits<double>::epsilon();
  for (std::size_t b = 0; b < found.balls.ids.size(); ++b) {
    const SphereId id = found.balls.ids[b];
    if (std::ranges::binary_search(arcs.suspect, id)) continue;
    // Arcs cannot tell a ball that is smaller than the rounding of its place from one that touches.
    const double r = std::max(spheres[id].radius, rounding);
    EXPECT_NEAR(std::ldexp(found.boundary.areas[b], 2 * found.balls.scale_exponent),
                arcs.per_sphere[id].area, kAreaError * r * r)
        << "ball " << id;
  }
}

TEST(Arrangement, OfSetsUnlikeProteins) {
  for_sets_of_families(
      350, [](const std::vector<Sphere>& balls, Dice&, unsigned) { expect_sound(balls); });
}

// Radii that differ by many powers of ten, coordinates that are larger than a SphereSet takes once
// the radii are near 1, and sets whose areas are no doubles.
TEST(Arrangement, OfExtremeSizes) {
  expect_sound({{{0, 0, 0}, 1}, {{1, 0, 0}, 1e-35}, {{0, 1, 0}, 0.5}});
  expect_sound({{{0, 0, 0}, 1e-20}, {{1e-20, 0, 0}, 1e-20}, {{1e20, 0, 0}, 1e-20}});
  const SphereSet too_far({{{0, 0, 0}, 1e30}, {{1e30, 0, 0}, 1e-300}, {{0, 1e30, 0}, 1e29}});
  EXPECT_THROW(arrange(too_far), InvalidInput);
}

TEST(Arrangement, OfHaemoglobin) {
  VDWMESH_NEEDS_SHARED("reference/4HHB.xyzr");
  for (const double probe : {0.0, 1.4}) {
    const SphereSet spheres = read_xyzr(shared_path("reference/4HHB.xyzr"), probe);
    expect_sound({spheres.spheres().begin(), spheres.spheres().end()});
  }
}

// Lattices, in which every corner is a tie, of so many balls that more cores have more blocks.
TEST(Arrangement, DoesNotDependOnTheNumberOfThreads) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 10 * 10 * 10; ++i) {
    balls.push_back({{1.0 * (i % 10), 1.0 * (i / 10 % 10), 1.0 * (i / 100)}, std::sqrt(0.5)});
  }
  const SphereSet spheres(balls);
  std::vector<Arrangement> found;
  for (const std::size_t threads : {1u, 3u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(arrange(spheres));
    const ExposedBoundary &alone = found[0].boundary, &together = found.back().boundary;
    EXPECT_TRUE(std::ranges::equal(together.arcs, alone.arcs));
    EXPECT_TRUE(std::ranges::equal(together.corners, alone.corners));
    EXPECT_EQ(together.areas, alone.areas);
  }
}

// The numbers of balls that stay do not depend on balls that are left out, as long as the box
// around the centres is the same.
TEST(PlacedBalls, OrderIsAMatterOfPlaces) {
  Dice dice(9);
  std::vector<Sphere> balls{{{-10, -10, -10}, 1}, {{10, 10, 10}, 1}};
  for (int i = 0; i < 500; ++i) balls.push_back({random_point(dice, 10), dice.real(0.5, 2)});
  const PlacedBalls all = placed_balls(SphereSet(balls));
  std::vector<Sphere> few(balls.begin(), balls.begin() + 250);
  const PlacedBalls some = placed_balls(SphereSet(few));
  std::vector<SphereId> kept;
  std::ranges::copy_if(all.ids, std::back_inserter(kept), [](SphereId id) { return id < 250; });
  EXPECT_EQ(some.ids, kept);
  std::ranges::reverse(balls);
  const PlacedBalls reversed = placed_balls(SphereSet(balls));
  ASSERT_EQ(reversed.ids.size(), all.ids.size());
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    EXPECT_EQ(reversed.ids[i], balls.size() - 1 - all.ids[i]);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
