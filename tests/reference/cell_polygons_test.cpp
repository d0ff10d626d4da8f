// The case handling, exhaustively: every cell alone and every pair of neighbouring cells.
#include "reference/cell_polygons.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

#include "reference/dense_mc.hpp"
#include "reference/mesh_checks.hpp"

namespace vdwmesh::reference {
namespace {

TEST(CellPolygons, NoCaseNeedsMoreThanFiveTriangles) {
  for (unsigned flag = 0; flag < 256; ++flag) EXPECT_LE(cell_triangles(flag).size(), 5u) << flag;
}

TEST(CellPolygons, UsesExactlyTheEdgesThatChangeSide) {
  for (unsigned flag = 0; flag < 256; ++flag) {
    std::set<int> used, expected;
    for (const auto& t : cell_triangles(flag)) used.insert(t.begin(), t.end());
    for (int e = 0; e < 12; ++e) {
      const CellEdge edge = cell_edges()[static_cast<std::size_t>(e)];
      if ((flag >> edge.a & 1u) != (flag >> edge.b & 1u)) expected.insert(e);
    }
    EXPECT_EQ(used, expected) << flag;
  }
}

// Two cells side by side in an otherwise empty grid: 4096 signs of their 12 corners, along each
// axis. Closed and 2-manifold says that the cells agree on the face they share, and that no
// diagonal lies in it.
TEST(CellPolygons, EveryPairOfNeighboursFitsTogether) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    DenseGrid grid{{0, 0, 0}, 1.0, {1, 1, 1}};
    grid.cells[axis] = 2;
    for (unsigned signs = 1; signs < 4096; ++signs) {
      const auto inside = [&](const Node& n) {
        const auto bit = (n[2] * (grid.cells[1] + 1) + n[1]) * (grid.cells[0] + 1) + n[0];
        return (signs >> bit & 1u) != 0;
      };
      const auto middle = [](const Point& a, const Point& b) { return 0.5 * (a + b); };
      const MeshFacts facts = inspect(dense_marching_cubes(grid, inside, middle).mesh);
      ASSERT_TRUE(facts.closed_oriented_manifold())
          << axis << ' ' << signs << ": " << facts.summary();
      ASSERT_GT(facts.volume, 0) << signs;
      ASSERT_EQ(facts.degenerate_triangles, 0u) << signs;
    }
  }
}

TEST(CellPolygons, SeparatesInsideCornersAcrossAFace) {
  // Corners 0 and 3 share the face z = 0 across its diagonal: two triangles, one per corner.
  EXPECT_EQ(cell_triangles(0b00001001u).size(), 2u);
  // The complement has its outside corners there, and joins them.
  EXPECT_EQ(cell_triangles(0b11110110u).size(), 4u);
}

}  // namespace
}  // namespace vdwmesh::reference
