// Labels, normals and orientation of single vertices and triangles.
#include "refine/subdivision_formulas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/errors.hpp"
#include "refine/half_edges.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

const std::vector<Sphere> kSpheres = {{{-1, 0, 0}, 2}, {{1, 0, 0}, 2}, {{1, 0, 0}, 2}};

TEST(NearerSphere, PrefersTheSmallerGapThenCanonicalOrder) {
  EXPECT_EQ(nearer_sphere(kSpheres.data(), 0, 1, {0.5, 1, 0}), 1u);
  EXPECT_EQ(nearer_sphere(kSpheres.data(), 1, 0, {0, 1, 0}), 0u);
  EXPECT_EQ(nearer_sphere(kSpheres.data(), 2, 1, {0, 1, 0}), 1u);
  EXPECT_EQ(nearer_sphere(kSpheres.data(), kNoSphere, 1, {0, 1, 0}), 1u);
  EXPECT_EQ(nearer_sphere(kSpheres.data(), 0, kNoSphere, {9, 1, 0}), 0u);
}

void expect_normal(const VertexSpheres& label, const Vec3d& p, const Vec3d& exact) {
  const Vec3f n = union_normal(kSpheres.data(), label.data(), p);
  EXPECT_LE(norm(cast<double>(n) - exact), 2e-7);  // floats
}

TEST(UnionNormal, OnACircleIsTheMeanOfBothSides) {
  const Vec3d p{0, std::sqrt(3.0), 0};
  expect_normal(on_sphere(0), p, {0.5, std::sqrt(3.0) / 2, 0});
  expect_normal({0, 1, kNoSphere}, p, {0, 1, 0});
}

TEST(UnionNormal, IsAUnitVectorWhereThereIsNoDirection) {
  expect_normal(on_sphere(0), kSpheres[0].center, {0, 0, 1});
  // Between the centres the two sides cancel; the first sphere's stands.
  expect_normal({0, 1, kNoSphere}, {0, 0, 0}, {1, 0, 0});
}

TEST(Facing, IsMeasuredAgainstTheAtoms) {
  const Vec3d p[3] = {{3, 0, 0}, {1, 2, 0}, {1, 0, 2}};
  const Vec3d back[3] = {p[0], p[2], p[1]};
  const SphereId one[3] = {1, 1, 1}, two[3] = {1, 1, 0}, none[3] = {1, 1, kNoSphere};
  EXPECT_EQ(facing(kSpheres.data(), p, one), Facing::outward);
  EXPECT_EQ(facing(kSpheres.data(), p, two), Facing::outward);
  EXPECT_EQ(facing(kSpheres.data(), back, one), Facing::against_one_atom);
  EXPECT_EQ(facing(kSpheres.data(), back, two), Facing::against_several_atoms);
  EXPECT_EQ(facing(kSpheres.data(), back, none), Facing::outward);
}

TEST(HalfEdges, EdgesAreNumberedByTheirFirstHalfEdge) {
  const IndexedMesh mesh = testing::octahedron();
  const Buffer<std::uint32_t> opposite = find_opposite(mesh), edge = number_edges(opposite);
  std::uint32_t next = 0;
  for (std::uint32_t h = 0; h < edge.size(); ++h) {
    if (h < opposite[h]) {
      EXPECT_EQ(edge[h], next++);
    } else {
      EXPECT_EQ(edge[h], edge[opposite[h]]);
    }
  }
  EXPECT_EQ(next, 12u);
}

// Two hubs with half a million spokes each. If every spoke looked through all half-edges of its
// hub, this would take 10^11 steps and more.
TEST(HalfEdges, OfHubsWithManySpokesAreFoundInTheShorterBucket) {
  constexpr std::uint32_t kSpokes = 1 << 19, kTop = kSpokes, kBottom = kSpokes + 1;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < kSpokes; ++i) {
    const std::uint32_t next = (i + 1) % kSpokes;
    triangles.push_back({i, next, kTop});
    triangles.push_back({next, i, kBottom});
  }
  const auto opposite = match_half_edges(triangles, kSpokes + 2);
  ASSERT_EQ(opposite.size(), 3 * triangles.size());
  std::size_t wrong = 0;
  for (std::uint32_t h = 0; h < opposite.size(); ++h) {
    const std::uint32_t back = opposite[h];
    wrong += back >= opposite.size() ||
             triangles[h / 3][h % 3] != triangles[back / 3][(back + 1) % 3] ||
             triangles[back / 3][back % 3] != triangles[h / 3][(h + 1) % 3];
  }
  EXPECT_EQ(wrong, 0u);
}

// An edge of three triangles has no opposites, whichever end has fewer half-edges.
TEST(HalfEdges, OfAnEdgeOfThreeTrianglesHaveNoOpposite) {
  for (const bool turned : {false, true}) {
    const std::uint32_t a = turned ? 1 : 0, b = 1 - a;
    const std::vector<Triangle> triangles{{a, b, 2}, {b, a, 3}, {b, a, 4}, {b, 5, 6}, {b, 6, 7}};
    const auto opposite = match_half_edges(triangles, 8);
    EXPECT_EQ(opposite[0], kUnmatched);
    EXPECT_EQ(opposite[3], 0u);
    EXPECT_EQ(opposite[6], 0u);
    EXPECT_EQ(opposite[11], 12u);  // from 6 to b, and back
    EXPECT_EQ(opposite[12], 11u);
  }
}

TEST(HalfEdges, TheFirstBadOneIsNamed) {
  try {
    find_opposite(testing::disc(4));
    FAIL() << "an open mesh was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("from vertex 1 to vertex 2 of triangle 0"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace vdwmesh
