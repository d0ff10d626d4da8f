#include "analysis/mesh_measures.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "analysis/survey/cgal_measures.hpp"
#include "core/errors.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using testing::KnownMesh;

// Relative; sums of fewer than 10^5 terms of equal sign, each rounded a few times.
constexpr double kSumRounding = 1e-13;
// Relative; plain double sums about a distant origin, as CGAL takes them.
constexpr double kPlainSumRounding = 1e-11;

void expect_close(double value, double expected, double relative) {
  EXPECT_LE(std::abs(value - expected), relative * std::abs(expected))
      << value << " where " << expected << " is expected";
}

class Known : public ::testing::TestWithParam<KnownMesh> {};

TEST_P(Known, Topology) {
  const KnownMesh& known = GetParam();
  const MeshTopology found = topology(known.mesh);
  EXPECT_EQ(found.closed, known.closed);
  EXPECT_EQ(found.manifold, known.manifold);
  EXPECT_EQ(found.oriented, known.oriented);
  EXPECT_EQ(found.vertices, known.mesh.vertex_count());
  EXPECT_EQ(found.isolated_vertices, 0u);
  EXPECT_EQ(found.triangles, known.mesh.triangle_count());
  EXPECT_EQ(found.shells, known.shells);
  EXPECT_EQ(found.euler_characteristic, known.euler_characteristic);
  EXPECT_EQ(found.genus, known.genus);
  EXPECT_EQ(found.components.has_value(), known.closed && known.oriented);
  EXPECT_EQ(found.components.value_or(0), known.components);
  EXPECT_EQ(found.voids.value_or(0), known.voids);
}

TEST_P(Known, Measures) {
  const KnownMesh& known = GetParam();
  const MeshMeasures found = measures(known.mesh);
  EXPECT_EQ(found.volume.has_value(), known.closed && known.oriented);
  if (!std::isnan(known.area)) expect_close(found.area, known.area, kSumRounding);
  if (found.volume && !std::isnan(known.volume))
    expect_close(*found.volume, known.volume, kSumRounding);
}

class KnownHalfEdge : public ::testing::TestWithParam<KnownMesh> {};

TEST_P(KnownHalfEdge, MeasuresAreWhatCgalFinds) {
  const KnownMesh& known = GetParam();
  const auto [topology, measures] = summarize(known.mesh);
  const CgalMeasures cgal = cgal_measures(to_surface_mesh(known.mesh), SelfIntersectionTest::run);
  EXPECT_TRUE(cgal.valid);
  EXPECT_EQ(cgal.closed, topology.closed);
  EXPECT_EQ(cgal.shells, topology.shells);
  expect_close(measures.area, cgal.area, kPlainSumRounding);
  ASSERT_EQ(cgal.volume.has_value(), measures.volume.has_value());
  if (cgal.volume) expect_close(*measures.volume, *cgal.volume, kPlainSumRounding);
  EXPECT_EQ(cgal.self_intersections, self_intersections(known.mesh));
}

INSTANTIATE_TEST_SUITE_P(All, Known, ::testing::ValuesIn(testing::known_meshes()),
                         [](const auto& info) { return info.param.name; });

INSTANTIATE_TEST_SUITE_P(All, KnownHalfEdge, ::testing::ValuesIn(testing::known_half_edge_meshes()),
                         [](const auto& info) { return info.param.name; });

TEST(Measures, OfVoidsSubtract) {
  const MeshMeasures found = measures(testing::hollow_cube());
  expect_close(found.outer_area.value(), 54, kSumRounding);
  expect_close(found.void_area.value(), 6, kSumRounding);
}

TEST(Measures, OfASphereConvergeWithOrderTwo) {
  const auto error = [](int level) {
    const MeshMeasures found = measures(testing::icosphere(level));
    return std::pair{4 * std::numbers::pi - found.area,
                     4 * std::numbers::pi / 3 - found.volume.value()};
  };
  const auto [area_4, volume_4] = error(4);
  const auto [area_5, volume_5] = error(5);
  // The next term of the error is of order 4, so the ratio is off 4 by about (edge length)² =
  // 0.005.
  constexpr double kRatioTolerance = 0.02;
  EXPECT_NEAR(area_4 / area_5, 4, kRatioTolerance);
  EXPECT_NEAR(volume_4 / volume_5, 4, kRatioTolerance);
}

TEST(Measures, OfATorusConverge) {
  const MeshMeasures found = measures(testing::torus(1200, 400));
  constexpr double kOrderTwo = 1e-4;  // relative: (2π/400)²/2 and smaller terms
  expect_close(found.area, 12 * std::numbers::pi * std::numbers::pi, kOrderTwo);
  expect_close(found.volume.value(), 6 * std::numbers::pi * std::numbers::pi, kOrderTwo);
}

TEST(Measures, DoNotMindTranslation) {
  // Coordinates keep 2^-40 Å at 5000 Å: 1e-12 of a unit sphere's diameter, which moves area and
  // volume by less than 1e-9 even if all roundings pulled the same way.
  constexpr double kTranslation = 1e-9;
  const IndexedMesh mesh = testing::icosphere(5);
  const MeshMeasures here = measures(mesh);
  const MeshMeasures there = measures(testing::translated(mesh, {5000, -5000, 5000}));
  expect_close(there.area, here.area, kTranslation);
  expect_close(there.volume.value(), here.volume.value(), kTranslation);
}

TEST(Measures, AreTheSameBitsAfterAnExactTranslation) {
  // Coordinates are multiples of 2^-20, so 2^20 is added to them without rounding, and what is
  // summed about the mesh's own middle does not change at all.
  IndexedMesh mesh = testing::icosphere(4);
  for (Vec3d& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p20) * 0x1p-20;
  const MeshMeasures here = measures(mesh);
  const MeshMeasures there = measures(testing::translated(mesh, {0x1p20, -0x1p20, 0x1p19}));
  EXPECT_EQ(there.area, here.area);
  EXPECT_EQ(there.volume, here.volume);
}

TEST(Measures, AreTheSameForAnyNumberOfThreads) {
  const IndexedMesh mesh = testing::icosphere(6);
  const auto with_threads = [&](std::size_t threads) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return measures(mesh);
  };
  EXPECT_EQ(with_threads(1).area, with_threads(4).area);
  EXPECT_EQ(with_threads(1).volume, with_threads(4).volume);
}

TEST(Topology, CountsIsolatedVerticesApart) {
  IndexedMesh mesh = testing::cube();
  mesh.positions.push_back({7, 7, 7});
  const MeshTopology found = topology(mesh);
  EXPECT_EQ(found.vertices, 9u);
  EXPECT_EQ(found.isolated_vertices, 1u);
  EXPECT_EQ(found.euler_characteristic, 2);
  EXPECT_TRUE(found.manifold);
}

TEST(Topology, SeesAVertexOfTwoFans) {
  const IndexedMesh bow_tie = testing::make_mesh(
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_FALSE(topology(bow_tie).manifold);
}

TEST(Topology, SeesADoubledEdge) {
  // What marching cubes makes where two cells both draw a diagonal in the face between them: two
  // closed surfaces through one edge.
  const MeshTopology found = topology(testing::tetrahedra_sharing_edge());
  EXPECT_FALSE(found.closed);
  EXPECT_FALSE(found.manifold);
}

TEST(Topology, SeesARepeatedIndex) {
  IndexedMesh mesh = testing::cube();
  mesh.triangles.push_back({1, 1, 2});
  EXPECT_FALSE(topology(mesh).manifold);
}

TEST(Topology, RefusesIndicesOfNoVertex) {
  IndexedMesh mesh = testing::cube();
  mesh.triangles[5][1] = 8;
  EXPECT_THROW(topology(mesh), InvalidInput);
}

TEST(CgalMeasures, SayWhichWayShellsAreWound) {
  EXPECT_EQ(cgal_measures(to_surface_mesh(testing::cube())).outward, true);
  EXPECT_EQ(cgal_measures(to_surface_mesh(testing::hollow_cube())).outward, true);
  EXPECT_EQ(cgal_measures(to_surface_mesh(testing::reversed(testing::cube()))).outward, false);
}

}  // namespace
}  // namespace vdwmesh
