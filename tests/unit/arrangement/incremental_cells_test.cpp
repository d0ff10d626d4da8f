// The regular triangulation by insertion into flat arrays, against CGAL's: the same cells with the
// same neighbours, or nothing where balls are in a tie.
#include "arrangement/complex/incremental_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <vector>

#include "arrangement/complex/placed_balls.hpp"
#include "support/dice.hpp"
#include "support/family_sets.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// For each cell the vertices of its four neighbours; those of a cell that is not there are empty.
using CellMap = std::map<CellVertices, std::array<std::vector<std::uint32_t>, 4>>;

CellMap map_of(const RegularCells& cells) {
  CellMap map;
  for (std::size_t c = 0; c < cells.cells.size(); ++c) {
    auto& around = map[cells.cells[c]];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = cells.neighbors[c][k];
      if (n != kNoIndex) around[k].assign(cells.cells[n].begin(), cells.cells[n].end());
    }
  }
  EXPECT_EQ(map.size(), cells.cells.size()) << "a cell stands there twice";
  return map;
}

// Returns whether the balls are without ties; if so, the cells were compared. `takes` chooses
// cells.
bool compare(const std::vector<Sphere>& spheres, const TakesCell& takes) {
  const std::vector<Sphere> balls = placed_balls(SphereSet(spheres)).balls;
  const std::array<Vec3d, 4> auxiliary = auxiliary_points(balls);
  std::vector<std::uint32_t> indices(balls.size());
  std::iota(indices.begin(), indices.end(), 0u);
  constexpr std::uint8_t kUntouched = 7;
  std::vector<std::uint8_t> has_vertex(balls.size(), kUntouched);
  const auto found =
      incremental_cells(balls, auxiliary, indices, takes, has_vertex, kNoMemoryLimit, nullptr);
  if (!found) {
    EXPECT_EQ(std::ranges::count(has_vertex, kUntouched), std::ssize(has_vertex));
    return false;
  }
  std::vector<std::uint8_t> expected_vertex(balls.size(), kUntouched);
  const RegularCells expected =
      regular_cells(balls, auxiliary, indices, takes, expected_vertex, kNoMemoryLimit, nullptr);
  EXPECT_TRUE(map_of(*found) == map_of(expected)) << balls.size() << " balls";
  EXPECT_EQ(has_vertex, expected_vertex);
  return true;
}

bool takes_all(const CellVertices&) { return true; }

TEST(IncrementalCells, OfSetsUnlikeProteins) {
  int without_ties = 0;
  for_sets_of_families(300, [&](const std::vector<Sphere>& balls, Dice&, unsigned) {
    without_ties += compare(balls, takes_all);
  });
  EXPECT_GT(without_ties, 100);
}

TEST(IncrementalCells, WithHiddenBallsAndUnevenSizes) {
  Dice dice(11);
  for (int set = 0; set < 20; ++set) {
    std::vector<Sphere> balls;
    for (int i = 0; i < 600; ++i) {
      const double radius = i % 50 == 0 ? dice.real(1, 8) : dice.real(0.01, 1.5);
      balls.push_back({random_point(dice, i % 7 == 0 ? 30 : 6), radius});
    }
    EXPECT_TRUE(compare(balls, takes_all));
  }
}

// Signs that double precision does not give: a lattice whose balls are moved by little, a plane, a
// line, and a sphere.
TEST(IncrementalCells, NearlyInATie) {
  Dice dice(12);
  for (const double moved : {1e-15, 1e-12, 1e-8}) {
    std::vector<Sphere> lattice, plane, line, sphere;
    for (int i = 0; i < 343; ++i) {
      const Vec3d at{1.0 * (i % 7), 1.0 * (i / 7 % 7), 1.0 * (i / 49)};
      lattice.push_back({at + random_point(dice, moved), 0.6});
      plane.push_back(
          {Vec3d{dice.real(0, 30), dice.real(0, 30), 5} + random_point(dice, moved), 1});
      line.push_back({Vec3d{0.3 * i, 0.1 * i, 7} + random_point(dice, moved), 1});
      const Vec3d p = random_point(dice, 1);
      sphere.push_back({(9 / norm(p)) * p + random_point(dice, moved), 1});
    }
    EXPECT_TRUE(compare(lattice, takes_all) || moved < 1e-13) << moved;
    EXPECT_TRUE(compare(plane, takes_all)) << moved;
    EXPECT_TRUE(compare(line, takes_all) || moved < 1e-9) << moved;
    EXPECT_TRUE(compare(sphere, takes_all)) << moved;
  }
}

// Centres so far apart for their radii that products of the filter overflow: its sums are then
// infinite or no numbers, while the bound of their errors may still be finite. Farther sets have no
// bound either, nearer ones no overflow.
TEST(IncrementalCells, SoFarApartThatTheFilterOverflows) {
  Dice dice(14);
  for (int exponent = 55; exponent <= 70; ++exponent) {
    SCOPED_TRACE(exponent);
    const double reach = 1e20, radius = reach * std::pow(10.0, -exponent);
    std::vector<Sphere> balls;
    for (int i = 0; i < 60; ++i) {
      balls.push_back({random_point(dice, reach), radius * dice.real(0.5, 1)});
    }
    EXPECT_TRUE(compare(balls, takes_all));
  }
}

TEST(IncrementalCells, TiesAreLeftToOthers) {
  std::vector<Sphere> lattice;
  for (int i = 0; i < 27; ++i) {
    lattice.push_back({{1.0 * (i % 3), 1.0 * (i / 3 % 3), 1.0 * (i / 9)}, 0.6});
  }
  EXPECT_FALSE(compare(lattice, takes_all));
}

TEST(IncrementalCells, OnlyCellsThatAreTaken) {
  Dice dice(13);
  std::vector<Sphere> balls;
  for (int i = 0; i < 500; ++i) balls.push_back({random_point(dice, 10), dice.real(1, 2)});
  EXPECT_TRUE(compare(balls, [](const CellVertices& v) { return v[0] % 3 != 0; }));
}

TEST(IncrementalCells, OfFewBalls) {
  EXPECT_TRUE(compare({{{0, 0, 0}, 1}}, takes_all));
  EXPECT_TRUE(compare({{{0, 0, 0}, 5}, {{0.3, 0.2, 0.1}, 1}}, takes_all));
}

}  // namespace
}  // namespace vdwmesh::testing
