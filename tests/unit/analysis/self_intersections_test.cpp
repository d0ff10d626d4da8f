#include <gtest/gtest.h>

#include "analysis/mesh_measures.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using testing::make_mesh;

TEST(SelfIntersections, OfCleanMeshesAreNone) {
  EXPECT_EQ(self_intersections(testing::icosphere(4)), 0u);
  EXPECT_EQ(self_intersections(testing::torus(30, 20)), 0u);
  EXPECT_EQ(self_intersections(testing::hollow_cube()), 0u);
  EXPECT_EQ(self_intersections(testing::tetrahedra_sharing_edge()), 0u);
}

TEST(SelfIntersections, OfTwoTrianglesThroughEachOther) {
  EXPECT_EQ(self_intersections(make_mesh(
                {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, -1}, {0.5, 0.5, 1}, {5, 5, 1}},
                {{0, 1, 2}, {3, 4, 5}})),
            1u);
}

TEST(SelfIntersections, AtASharedVertex) {
  // The second triangle goes through the first; only a vertex is shared by index.
  EXPECT_EQ(self_intersections(make_mesh({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 1, -1}, {1, 1, 1.5}},
                                         {{0, 1, 2}, {0, 3, 4}})),
            1u);
  EXPECT_EQ(
      self_intersections(make_mesh({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {-1, -1, -1}, {-1, -1, 1}},
                                   {{0, 1, 2}, {0, 3, 4}})),
      0u);
}

TEST(SelfIntersections, OfAFold) {
  // Neighbours in one plane: folded over they overlap, unfolded they do not.
  const auto fold = [](double x) {
    return self_intersections(
        make_mesh({{0, 0, 0}, {0, 1, 0}, {1, 0.5, 0}, {x, 0.5, 0}}, {{0, 2, 1}, {0, 1, 3}}));
  };
  EXPECT_EQ(fold(0.5), 1u);
  EXPECT_EQ(fold(-0.5), 0u);
}

TEST(SelfIntersections, OfADuplicateTriangle) {
  EXPECT_EQ(
      self_intersections(make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {2, 1, 0}})), 1u);
}

TEST(SelfIntersections, OfTwoSpheresThatOverlap) {
  const IndexedMesh sphere = testing::icosphere(3);
  EXPECT_GT(self_intersections(testing::together(sphere, testing::translated(sphere, {1, 0, 0}))),
            0u);
  EXPECT_EQ(self_intersections(testing::together(sphere, testing::translated(sphere, {3, 0, 0}))),
            0u);
}

}  // namespace
}  // namespace vdwmesh
