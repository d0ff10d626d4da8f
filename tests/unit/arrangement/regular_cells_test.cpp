// The regular triangulation by insertion into flat arrays, against CGAL's: the same cells with the
// same neighbours, also where balls are in a tie.
#include "complex/regular_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "cgal_cells.hpp"
#include "complex/placed_balls.hpp"
#include "core/errors.hpp"
#include "core/no_index.hpp"
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

bool takes_all(const CellVertices&) { return true; }

// `takes` chooses cells.
void compare(const std::vector<Sphere>& spheres, const TakesCell& takes = takes_all) {
  const std::vector<Sphere> balls = placed_balls(SphereSet(spheres)).balls;
  const std::array<Vec3d, 4> auxiliary = auxiliary_points(balls);
  std::vector<std::uint32_t> indices(balls.size());
  std::iota(indices.begin(), indices.end(), 0u);
  constexpr std::uint8_t kUntouched = 7;
  std::vector<std::uint8_t> has_vertex(balls.size(), kUntouched), expected_vertex = has_vertex;
  const RegularCells found =
      regular_cells(balls, auxiliary, indices, takes, has_vertex, kNoMemoryLimit, nullptr);
  const RegularCells expected = cgal_cells(balls, auxiliary, takes, expected_vertex);
  EXPECT_TRUE(map_of(found) == map_of(expected)) << balls.size() << " balls";
  EXPECT_EQ(has_vertex, expected_vertex);
}

TEST(RegularCellsTest, OfSetsUnlikeProteins) {
  for_sets_of_families(300,
                       [](const std::vector<Sphere>& balls, Dice&, unsigned) { compare(balls); });
}

TEST(RegularCellsTest, WithHiddenBallsAndUnevenSizes) {
  Dice dice(11);
  for (int set = 0; set < 20; ++set) {
    std::vector<Sphere> balls;
    for (int i = 0; i < 600; ++i) {
      const double radius = i % 50 == 0 ? dice.real(1, 8) : dice.real(0.01, 1.5);
      balls.push_back({random_point(dice, i % 7 == 0 ? 30 : 6), radius});
    }
    compare(balls);
  }
}

// Signs that double precision does not give: a lattice whose balls are moved by little, a plane, a
// line, and a sphere.
TEST(RegularCellsTest, NearlyInATie) {
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
    compare(lattice);
    compare(plane);
    compare(line);
    compare(sphere);
  }
}

// Centres so far apart for their radii that products of the filter overflow: its sums are then
// infinite or no numbers, while the bound of their errors may still be finite. Farther sets have no
// bound either, nearer ones no overflow.
TEST(RegularCellsTest, SoFarApartThatTheFilterOverflows) {
  Dice dice(14);
  for (int exponent = 55; exponent <= 70; ++exponent) {
    SCOPED_TRACE(exponent);
    const double reach = 1e20, radius = reach * std::pow(10.0, -exponent);
    std::vector<Sphere> balls;
    for (int i = 0; i < 60; ++i) {
      balls.push_back({random_point(dice, reach), radius * dice.real(0.5, 1)});
    }
    compare(balls);
  }
}

// Lattices, balls in a plane and on a line, and balls in one orthogonal sphere, some of them hidden
// and others of two sizes: ties of any number of balls, and ties of a ball that is hardly hidden.
TEST(RegularCellsTest, InATie) {
  std::vector<Sphere> lattice, centered, plane, line, shell;
  for (int i = 0; i < 512; ++i) {
    const Vec3d at{1.0 * (i % 8), 1.0 * (i / 8 % 8), 1.0 * (i / 64)};
    lattice.push_back({at, i % 3 == 0 ? 0.5 : 0.6});
    centered.push_back({at, 1});
    centered.push_back({at + Vec3d{0.5, 0.5, 0.5}, 0.5});
    plane.push_back({{at.x, at.y + 8 * at.z, 3}, 0.6});
    line.push_back({{0.25 * i, 0.5 * i, 7}, 1});
  }
  for (const int x : {-7, -5, -1, 1, 5, 7}) {
    for (const int y : {-7, -5, -1, 1, 5, 7}) {
      if (x * x + y * y == 50) shell.push_back({{1.0 * x, 1.0 * y, 0}, 1});
      if (x * x + y * y == 26) shell.push_back({{1.0 * x, 1.0 * y, 5}, 2});
      if (x * x + y * y == 26) shell.push_back({{1.0 * x, 1.0 * y, -5}, 2});
    }
  }
  for (const auto& balls : {lattice, centered, plane, line, shell}) compare(balls);
}

TEST(RegularCellsTest, OnlyCellsThatAreTaken) {
  Dice dice(13);
  std::vector<Sphere> balls;
  for (int i = 0; i < 500; ++i) balls.push_back({random_point(dice, 10), dice.real(1, 2)});
  compare(balls, [](const CellVertices& v) { return v[0] % 3 != 0; });
}

TEST(RegularCellsTest, OfFewBalls) {
  compare({{{0, 0, 0}, 1}});
  compare({{{0, 0, 0}, 5}, {{0.3, 0.2, 0.1}, 1}});
}

}  // namespace
}  // namespace vdwmesh::testing
