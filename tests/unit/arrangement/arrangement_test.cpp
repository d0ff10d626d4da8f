// The arrangement that the crease-exact mesher makes from power cells, against the one that follows
// from the exact dual complex of all balls: the same corners, the same arcs, in the same order. And
// the order of the balls.
#include "creases/arcs/arrangement.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include "core/errors.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "support/family_sets.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

std::vector<std::uint32_t> neighbors(const ExposedBoundary& boundary, std::uint32_t ball) {
  const auto row = boundary.neighbors(ball);
  return {row.begin(), row.end()};
}

// Of balls without arcs the neighbours do not count.
void expect_same_neighbors(const ExposedBoundary& found, const ExposedBoundary& exact) {
  std::vector<std::uint8_t> has_arcs(exact.areas.size(), 0);
  for (const CornerArc& arc : exact.arcs) has_arcs[arc.balls[0]] = has_arcs[arc.balls[1]] = 1;
  for (std::uint32_t b = 0; b < has_arcs.size(); ++b) {
    if (has_arcs[b]) {
      ASSERT_EQ(neighbors(found, b), neighbors(exact, b)) << "ball " << b;
    }
  }
}

// Returns how many balls the cells did not decide.
std::uint64_t expect_as_in_complex(const std::vector<Sphere>& balls) {
  const SphereSet spheres(balls);
  const Arrangement found = arrange(spheres);
  const PowerTriangulation t = triangulate(spheres);
  const ExposedBoundary exact = exposed_boundary(t, dual_complex(t));
  EXPECT_EQ(found.balls.ids, t.ids);
  EXPECT_TRUE(std::ranges::equal(found.boundary.corners, exact.corners));
  EXPECT_TRUE(std::ranges::equal(found.boundary.arcs, exact.arcs));
  expect_same_neighbors(found.boundary, exact);
  // Areas of balls of which nothing is in doubt are wrong by up to 1e-9 of the squared radius for
  // each of their corners (arcs::kMaxError), of which there are at most some hundred.
  constexpr double kAreaError = 1e-6;
  EXPECT_EQ(found.boundary.areas.size(), exact.areas.size());
  for (std::size_t b = 0; b < exact.areas.size(); ++b) {
    const double r = t.balls[b].radius;
    EXPECT_NEAR(found.boundary.areas[b], exact.areas[b], kAreaError * r * r) << "ball " << b;
  }
  return static_cast<std::uint64_t>(std::ranges::count(found.is_doubtful, 1));
}

// A heap of balls that the cells decide, far from all balls of a family, and larger than these.
std::vector<Sphere> beside_a_heap(std::vector<Sphere> balls, Dice& dice) {
  const Vec3d aside{1000, 0, 0};
  const std::size_t heap = 2 * balls.size() + 100;
  for (std::size_t i = 0; i < heap; ++i) {
    balls.push_back({aside + random_point(dice, 8), dice.real(0.8, 1.6)});
  }
  return balls;
}

TEST(Arrangement, OfSetsUnlikeProteinsIsThatOfTheDualComplex) {
  std::uint64_t triangulated = 0;
  for_sets_of_families(350, [&](std::vector<Sphere> balls, Dice& dice, unsigned seed) {
    if (seed % 2 == 0) balls = beside_a_heap(std::move(balls), dice);
    triangulated += expect_as_in_complex(balls);
  });
  EXPECT_GT(triangulated, 0u);  // lattices and twins
}

// Of balls far from a lattice, in which every corner is a tie, none is triangulated.
TEST(Arrangement, TriangulatesAroundDoubtsAlone) {
  Dice dice(5);
  std::vector<Sphere> balls;
  for (int i = 0; i < 27; ++i) {
    balls.push_back({{1.0 * (i % 3), 1.0 * (i / 3 % 3), 1.0 * (i / 9)}, std::sqrt(0.5)});
  }
  balls = beside_a_heap(std::move(balls), dice);
  const std::uint64_t triangulated = expect_as_in_complex(balls);
  EXPECT_GT(triangulated, 0u);
  EXPECT_LE(triangulated, 27u);
}

// Two balls that touch, from outside and from inside, beside balls that do not.
TEST(Arrangement, OfContacts) {
  Dice dice(6);
  for (const double apart : {2.0, 0.5}) {
    for (const double step : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6}) {
      SCOPED_TRACE(::testing::Message() << apart << " and " << step);
      const std::vector<Sphere> pair{{{0, 0, 0}, 1.25}, {{apart + step, 0, 0}, 0.75}};
      expect_as_in_complex(beside_a_heap(pair, dice));
    }
  }
}

// Radii that differ by more powers of ten than the cells take, coordinates that are larger than a
// SphereSet takes once the radii are near 1, and sets whose areas are no doubles.
TEST(Arrangement, OfExtremeSizes) {
  expect_as_in_complex({{{0, 0, 0}, 1}, {{1, 0, 0}, 1e-35}, {{0, 1, 0}, 0.5}});
  expect_as_in_complex({{{0, 0, 0}, 1e-20}, {{1e-20, 0, 0}, 1e-20}, {{1e20, 0, 0}, 1e-20}});
  const SphereSet too_far({{{0, 0, 0}, 1e30}, {{1e30, 0, 0}, 1e-300}, {{0, 1e30, 0}, 1e29}});
  EXPECT_THROW(arrange(too_far), InvalidInput);
}

TEST(Arrangement, OfConcentricBalls) {
  Dice dice(7);
  std::vector<Sphere> balls = beside_a_heap(dense_heap(dice), dice);
  const std::size_t count = balls.size();
  for (std::size_t i = 0; i < count; i += 3) {
    balls.push_back(balls[i]);
    if (i % 2 == 0) balls.back().radius *= 0.9;
  }
  expect_as_in_complex(balls);
}

// Of a protein, the cells decide all but a few balls.
TEST(Arrangement, OfHaemoglobin) {
  VDWMESH_NEEDS_SHARED("reference/4HHB.xyzr");
  for (const double probe : {0.0, 1.4}) {
    const SphereSet spheres = read_xyzr(shared_path("reference/4HHB.xyzr"), probe);
    const std::uint64_t triangulated =
        expect_as_in_complex({spheres.spheres().begin(), spheres.spheres().end()});
    EXPECT_LE(triangulated, spheres.size() / 100);
  }
}

// All small sets that lie beside the project: molecules, and sets made to be awkward.
TEST(Arrangement, OfAllSharedSets) {
  VDWMESH_NEEDS_SHARED("molecules/traps");
  constexpr std::uintmax_t kSmall = 100'000;  // bytes
  int sets = 0;
  for (const char* folder :
       {"reference", "molecules/odd", "molecules/sparse", "molecules/special", "molecules/traps"}) {
    for (const auto& file : std::filesystem::directory_iterator(shared_path(folder))) {
      if (file.path().extension() != ".xyzr" || file.file_size() > kSmall) continue;
      SCOPED_TRACE(file.path().filename().string());
      ++sets;
      const SphereSet spheres = read_xyzr(file.path());
      expect_as_in_complex({spheres.spheres().begin(), spheres.spheres().end()});
    }
  }
  EXPECT_GT(sets, 20);
}

// Where units in the last place of coordinates are up to a quarter of a radius, balls that touch
// balls in doubt are found as they are near the origin: the rows fit together, so that not all is
// triangulated.
TEST(Arrangement, OfBallsFarFromTheOrigin) {
  Dice dice(10);
  for (const int exponent : {0, 34, 40, 50}) {
    SCOPED_TRACE(exponent);
    std::vector<Sphere> balls{{{-9, 0, 0}, 1.25},       {{-7, 0, 0}, 0.75},
                              {{-6.5, 0, 0}, 1.25},     {{0.75, 1.25, 3}, 1.3},
                              {{0.75, -1.5, 0.5}, 1.1}, {{-8, 1, 0.25}, 0.9}};
    for (int i = 0; i < 27; ++i) {
      balls.push_back({{1.0 * (i % 3), 1.0 * (i / 3 % 3), 1.0 * (i / 9)}, std::sqrt(0.5)});
    }
    balls = beside_a_heap(std::move(balls), dice);
    const double far = std::ldexp(1.0, exponent);
    for (Sphere& s : balls) s.center = s.center + Vec3d{far, -far, far};
    EXPECT_GT(expect_as_in_complex(balls), 0u);
    EXPECT_FALSE(arrange(SphereSet(balls)).whole.has_value());
  }
}

// So many balls are in doubt that they are triangulated in more blocks on more cores.
TEST(Arrangement, DoesNotDependOnTheNumberOfThreads) {
  Dice dice(8);
  std::vector<Sphere> balls;
  for (int i = 0; i < 10 * 10 * 10; ++i) {
    balls.push_back({{1.0 * (i % 10), 1.0 * (i / 10 % 10), 1.0 * (i / 100)}, std::sqrt(0.5)});
  }
  for (const std::vector<Sphere>& set : {balls, beside_a_heap(balls, dice)}) {
    const SphereSet spheres(set);
    std::vector<Arrangement> found;
    for (const std::size_t threads : {1u, 3u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      found.push_back(arrange(spheres));
      const ExposedBoundary &alone = found[0].boundary, &together = found.back().boundary;
      EXPECT_TRUE(std::ranges::equal(together.arcs, alone.arcs));
      EXPECT_TRUE(std::ranges::equal(together.corners, alone.corners));
      EXPECT_EQ(together.areas, alone.areas);
      EXPECT_EQ(found.back().is_doubtful, found[0].is_doubtful);
    }
    EXPECT_GE(std::ranges::count(found[0].is_doubtful, 1), 1000);
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
