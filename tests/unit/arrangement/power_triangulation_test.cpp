// The regular triangulation made in blocks of space, against that made in one piece. Cells, their
// order and their neighbours must be equal; that of one piece is checked by other tests.
#include "complex/power_triangulation.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <vector>

#include "measures/exact_union.hpp"
#include "support/family_sets.hpp"

namespace vdwmesh::testing {
namespace {

// Space is cut into as many blocks as a set of this size can have.
void expect_same_in_blocks(const std::vector<Sphere>& balls) {
  const SphereSet spheres(balls);
  const PowerTriangulation whole = triangulate(spheres, nullptr, 1);
  for (const std::size_t blocks : {2, 3, 8}) {
    const PowerTriangulation joined = triangulate(spheres, nullptr, blocks);
    ASSERT_EQ(joined.ids, whole.ids);
    ASSERT_TRUE(std::ranges::equal(joined.cells, whole.cells)) << blocks << " blocks";
    ASSERT_TRUE(std::ranges::equal(joined.neighbors, whole.neighbors)) << blocks << " blocks";
  }
}

TEST(PowerTriangulationInBlocks, OfSetsUnlikeProteins) {
  for_sets_of_families(
      200, [](const std::vector<Sphere>& balls, Dice&, unsigned) { expect_same_in_blocks(balls); });
}

// Every cube of eight balls is a tie, which CGAL decides by the places of the balls.
TEST(PowerTriangulationInBlocks, OfALattice) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 1728; ++i) {
    balls.push_back({{1.0 * (i % 12), 1.0 * (i / 12 % 12), 1.0 * (i / 144)}, 0.6});
  }
  expect_same_in_blocks(balls);
}

// Two dense clouds in a thin gas, with balls of a hundred times the others' size.
TEST(PowerTriangulationInBlocks, OfUnevenSets) {
  Dice dice(3);
  std::vector<Sphere> balls;
  for (int i = 0; i < 3000; ++i) {
    const Vec3d cloud{i % 2 == 0 ? 0.0 : 40.0, 0, 0};
    balls.push_back({cloud + random_point(dice, i % 10 == 0 ? 60 : 3), dice.real(0.1, 1)});
    if (i % 1000 == 0) balls.back().radius = 30;
  }
  expect_same_in_blocks(balls);
}

TEST(PowerTriangulationInBlocks, OfBallsInAPlaneAndOnALine) {
  Dice dice(4);
  std::vector<Sphere> plane, line;
  for (int i = 0; i < 400; ++i) {
    plane.push_back({{dice.real(0, 30), dice.real(0, 30), 5}, 1});
    line.push_back({{1.0 * i, 0, 0}, 1});
  }
  expect_same_in_blocks(plane);
  expect_same_in_blocks(line);
}

// All parallel loops of the exact union by triangulation, on a set that is large enough for them.
TEST(PowerTriangulationInBlocks, AnyNumberOfThreadsGivesTheSameUnion) {
  Dice dice(6);
  std::vector<Sphere> balls;
  for (int i = 0; i < 3000; ++i) balls.push_back({random_point(dice, 12), dice.real(0.8, 1.6)});
  const SphereSet spheres(balls);
  triangulate(spheres, nullptr, 3);
  const ExactUnion free = exact_union(spheres);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ExactUnion alone = exact_union(spheres);
  EXPECT_EQ(free.area, alone.area);
  EXPECT_EQ(free.volume, alone.volume);
  EXPECT_EQ(free.topology->voids, alone.topology->voids);
  EXPECT_EQ(free.topology->tunnels, alone.topology->tunnels);
  EXPECT_EQ(free.topology->void_volume, alone.topology->void_volume);
}

// More blocks than balls, and balls of one place.
TEST(PowerTriangulationInBlocks, OfFewBalls) {
  expect_same_in_blocks({{{0, 0, 0}, 1}});
  expect_same_in_blocks({{{0, 0, 0}, 1}, {{0, 0, 0}, 2}, {{1, 0, 0}, 1}});
  expect_same_in_blocks({{{0, 0, 0}, 5}, {{1, 0, 0}, 1}, {{0, 1, 0}, 1}, {{-1, 0, 0}, 1}});
}

}  // namespace
}  // namespace vdwmesh::testing
