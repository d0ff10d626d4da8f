#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <map>
#include <random>

#include "core/errors.hpp"
#include "mesh/surface_mesh.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

// The same question answered with a map from directed edges.
std::vector<std::uint32_t> opposite_by_map(const IndexedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> half_edges;
  std::uint32_t h = 0;
  for (const Triangle& t : mesh.triangles)
    for (unsigned k = 0; k < 3; ++k) half_edges[{t[k], t[(k + 1) % 3]}] = h++;
  std::vector<std::uint32_t> opposite;
  for (const Triangle& t : mesh.triangles)
    for (unsigned k = 0; k < 3; ++k) {
      const auto found = half_edges.find({t[(k + 1) % 3], t[k]});
      opposite.push_back(found == half_edges.end() ? kNoOpposite : found->second);
    }
  return opposite;
}

void expect_as_by_map(const IndexedMesh& mesh) {
  const auto opposite = opposite_half_edges(mesh.triangles, mesh.vertex_count());
  EXPECT_TRUE(std::ranges::equal(opposite, opposite_by_map(mesh)));
}

TEST(OppositeHalfEdges, AgreeWithAMap) {
  for (const auto& known : testing::known_meshes())
    if (known.manifold && known.oriented) expect_as_by_map(known.mesh);
  expect_as_by_map(testing::icosphere(5));
}

TEST(OppositeHalfEdges, DoNotMindTheOrderOfTriangles) {
  IndexedMesh mesh = testing::torus(60, 40);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(1));
  expect_as_by_map(mesh);
}

TEST(OppositeHalfEdges, StayLinearAroundAVertexOfHighDegree) {
  expect_as_by_map(testing::disc(200'000));
}

TEST(OppositeHalfEdges, AreTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = testing::icosphere(6);
  const auto with_threads = [&](std::size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return opposite_half_edges(mesh.triangles, mesh.vertex_count());
  };
  EXPECT_EQ(with_threads(1), with_threads(4));
}

TEST(OppositeHalfEdges, RefuseMoreThanOpenMeshCanHold) {
  // The size is judged before any triangle is read.
  const std::span<const Triangle> huge(static_cast<const Triangle*>(nullptr),
                                       std::size_t{0x7fffffff} / 3 + 1);
  EXPECT_THROW(opposite_half_edges(huge, 1), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
