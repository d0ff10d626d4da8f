// What every refinement keeps: counts, indices, closedness, orientation, topology; the same bits
// for any number of threads and on both backends; permuted labels for permuted spheres.
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "contract/refiner_contract.hpp"
#include "support/worst.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerInvariant : public RefinerContract {};

void expect_opposites(const IndexedMesh& mesh) {
  ASSERT_EQ(mesh.opposite.size(), 3 * mesh.triangle_count());
  const auto start = [&](std::size_t h) { return mesh.triangles[h / 3][h % 3]; };
  const auto end = [&](std::size_t h) { return mesh.triangles[h / 3][(h + 1) % 3]; };
  for (std::size_t h = 0; h < mesh.opposite.size(); ++h) {
    const std::size_t back = mesh.opposite[h];
    ASSERT_LT(back, mesh.opposite.size());
    ASSERT_EQ(mesh.opposite[back], h);
    ASSERT_EQ(start(back), end(h));
    ASSERT_EQ(end(back), start(h));
  }
}

// The children by the contract's own words: midpoints in the order of their edges' first
// half-edges.
Buffer<Triangle> children(const IndexedMesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto next = static_cast<std::uint32_t>(mesh.vertex_count() + midpoints.size());
    return midpoints.try_emplace({std::min(a, b), std::max(a, b)}, next).first->second;
  };
  Buffer<Triangle> result;
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    for (const Triangle& t :
         {Triangle{a, ab, ca}, Triangle{b, bc, ab}, Triangle{c, ca, bc}, Triangle{ab, bc, ca}}) {
      result.push_back(t);
    }
  }
  return result;
}

TEST_P(RefinerInvariant, CountsIndicesAndTopologyAreKept) {
  for (const KnownMesh& known : known_meshes()) {
    if (!known.closed || !known.oriented || !known.manifold || known.shells == 0) continue;
    IndexedMesh mesh = known.mesh;
    for (int level = 1; level <= 2; ++level) {
      const RefineResult result = refine({}, mesh, refine_options(1, Projection::none));
      const reference::MeshFacts before = facts_of(mesh), after = facts_of(result.mesh);
      EXPECT_EQ(after.vertices, before.vertices + before.edges) << known.name;
      EXPECT_EQ(after.triangles, 4 * before.triangles) << known.name;
      EXPECT_TRUE(after.closed_oriented_manifold()) << known.name << after.summary();
      EXPECT_EQ(after.euler_characteristic(), known.euler_characteristic) << known.name;
      // Flat triangles cut up: nothing but rounding.
      EXPECT_NEAR(after.area / before.area, 1, 1e-12) << known.name;
      EXPECT_NEAR(after.volume / before.volume, 1, 1e-12) << known.name;
      EXPECT_EQ(result.mesh.triangles, children(mesh)) << known.name;
      expect_opposites(result.mesh);
      mesh = result.mesh;
    }
  }
}

TEST_P(RefinerInvariant, ObserverSeesTheGivenMeshAndEachLevel) {
  const SphereSet spheres = two_spheres(1.5, 1.2, 1.6);
  const IndexedMesh given = marching_cubes(spheres, 0.5).mesh;
  RefineOptions options = refine_options(2, Projection::vdw);
  std::vector<IndexedMesh> seen;
  options.on_level = [&](int level, const IndexedMesh& mesh) {
    ASSERT_EQ(level, static_cast<int>(seen.size()));
    seen.push_back(mesh);
  };
  const RefineResult result = refine(spheres, given, options);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].positions, given.positions);
  EXPECT_EQ(seen[1].triangle_count(), 4 * given.triangle_count());
  EXPECT_EQ(seen[2].positions, result.mesh.positions);
  EXPECT_EQ(seen[2].triangles, result.mesh.triangles);
}

TEST_P(RefinerInvariant, LevelsFollowOneAnother) {
  const SphereSet spheres = cluster(40, 21);
  const IndexedMesh mesh = marching_cubes(spheres, 0.6).mesh;
  IndexedMesh step = mesh;
  for (int level = 0; level < 3; ++level) {
    step = refine(spheres, step, refine_options(1, Projection::vdw)).mesh;
  }
  const RefineResult at_once = refine(spheres, mesh, refine_options(3, Projection::vdw));
  EXPECT_EQ(step.triangles, at_once.mesh.triangles);
  EXPECT_EQ(step.opposite, at_once.mesh.opposite);
  EXPECT_EQ(step.vertex_count(), at_once.mesh.vertex_count());
}

TEST_P(RefinerInvariant, ProjectionKeepsClosednessOrientationAndTopology) {
  const SphereSet ring = ring_of_spheres(12, 4, 1.6);
  const RefineResult result =
      refine(ring, marching_cubes(ring, 0.4).mesh, refine_options(2, Projection::vdw));
  const reference::MeshFacts facts = facts_of(result.mesh);
  EXPECT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
  EXPECT_EQ(facts.euler_characteristic(), 0);
  EXPECT_EQ(facts.bad_numbers, 0u);
  expect_opposites(result.mesh);
  for (const Vec3f& n : result.mesh.normals) ASSERT_NEAR(norm(n), 1, 1e-6);
}

TEST_P(RefinerInvariant, GivenOppositesMakeNoDifference) {
  const SphereSet spheres = cluster(40, 22);
  ExtractOptions options;
  options.connectivity = Connectivity::half_edges;
  const IndexedMesh with = make_cpu_extractor()->extract(spheres, options).mesh;
  IndexedMesh without = with;
  ASSERT_FALSE(with.opposite.empty());
  without.opposite.clear();
  const RefineOptions once = refine_options(1, Projection::vdw);
  const IndexedMesh a = refine(spheres, with, once).mesh, b = refine(spheres, without, once).mesh;
  EXPECT_EQ(hash(a), hash(b));
  EXPECT_EQ(a.opposite, b.opposite);
}

// The same mesh but for what was not asked for; levels that are divided further have half-edges
// whatever is asked for.
TEST_P(RefinerInvariant, WhatIsNotReadIsNotMade) {
  const SphereSet spheres = cluster(40, 26);
  const ExtractResult extracted = marching_cubes(spheres, 0.6, FieldKind::blinn);
  for (const Projection projection : {Projection::vdw, Projection::field, Projection::none}) {
    for (const int subdivisions : {1, 2}) {
      RefineOptions options = field_options(subdivisions, FieldKind::blinn, extracted.grid);
      options.projection = projection;
      const RefineResult all = refine(spheres, extracted.mesh, options);
      ASSERT_FALSE(all.mesh.normals.empty());
      const std::uint64_t triangles = all.mesh.triangle_count();
      options.normals = Normals::none;
      for (const std::uint64_t up_to : {std::uint64_t{0}, triangles - 1, triangles}) {
        options.half_edges_up_to = up_to;
        RefineResult part = refine(spheres, extracted.mesh, options);
        EXPECT_TRUE(part.mesh.normals.empty());
        EXPECT_EQ(part.mesh.opposite.empty(), up_to < triangles);
        if (up_to == triangles) {
          EXPECT_EQ(part.mesh.opposite, all.mesh.opposite);
        }
        part.mesh.normals = all.mesh.normals;
        part.mesh.opposite = all.mesh.opposite;
        EXPECT_EQ(hash(part.mesh), hash(all.mesh));
        ASSERT_EQ(part.levels.size(), all.levels.size());
        for (std::size_t l = 0; l < all.levels.size(); ++l) {
          EXPECT_EQ(part.levels[l].undone, all.levels[l].undone);
          EXPECT_EQ(part.levels[l].turned, all.levels[l].turned);
        }
      }
    }
  }
}

TEST_P(RefinerInvariant, PermutedSpheresPermuteTheLabels) {
  const SphereSet spheres = cluster(50, 23);
  const auto count = static_cast<SphereId>(spheres.size());
  std::vector<Sphere> reversed(spheres.spheres().rbegin(), spheres.spheres().rend());
  const SphereSet permuted(reversed);
  const RefineOptions once = refine_options(1, Projection::vdw);
  const IndexedMesh a = refine(spheres, marching_cubes(spheres, 0.5).mesh, once).mesh;
  const IndexedMesh b = refine(permuted, marching_cubes(permuted, 0.5).mesh, once).mesh;
  ASSERT_EQ(a.positions, b.positions);
  ASSERT_EQ(a.triangles, b.triangles);
  for (std::size_t v = 0; v < a.vertex_count(); ++v) {
    VertexSpheres back = b.vertex_spheres[v];
    for (SphereId& id : back) id = id == kNoSphere ? id : count - 1 - id;
    ASSERT_EQ(a.vertex_spheres[v], back);
  }
}

class RefinerDeterminism : public RefinerContract {
 protected:
  RefineResult with_threads(std::size_t threads, Projection projection) const {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const SphereSet spheres = cluster(150, 24);
    const FieldKind kind = projection == Projection::field ? FieldKind::blinn : FieldKind::vdw;
    const ExtractResult extracted = marching_cubes(spheres, 0.5, kind);
    RefineOptions options = field_options(2, kind, extracted.grid);
    options.projection = projection;
    return refine(spheres, extracted.mesh, options);
  }
};

TEST_P(RefinerDeterminism, ThreadsDoNotMatter) {
  for (const Projection projection : {Projection::vdw, Projection::field, Projection::none}) {
    const RefineResult one = with_threads(1, projection);
    for (const std::size_t threads : {2u, 3u, 8u}) {
      const RefineResult more = with_threads(threads, projection);
      EXPECT_EQ(hash(more.mesh), hash(one.mesh)) << threads << " threads";
      EXPECT_EQ(more.mesh.opposite, one.mesh.opposite);
      for (std::size_t l = 0; l < one.levels.size(); ++l) {
        EXPECT_EQ(more.levels[l].projected, one.levels[l].projected);
        EXPECT_EQ(more.levels[l].undone, one.levels[l].undone);
        EXPECT_EQ(more.levels[l].turned, one.levels[l].turned);
        EXPECT_EQ(more.levels[l].residual_max, one.levels[l].residual_max);
      }
    }
  }
}

TEST_P(RefinerDeterminism, BackendsAgree) {
  if (GetParam() == Backend::cpu) GTEST_SKIP() << "the backend compared with";
  for (const Projection projection : {Projection::vdw, Projection::field, Projection::none}) {
    const SphereSet spheres = cluster(150, 25);
    const FieldKind kind = projection == Projection::field ? FieldKind::blinn : FieldKind::vdw;
    const ExtractResult extracted = marching_cubes(spheres, 0.5, kind);
    RefineOptions options = field_options(2, kind, extracted.grid);
    options.projection = projection;
    const IndexedMesh cpu =
        make_refiner(Backend::cpu)->refine(spheres, extracted.mesh, options).mesh;
    const IndexedMesh device = refine(spheres, extracted.mesh, options).mesh;
    EXPECT_EQ(hash(device), hash(cpu));
    EXPECT_EQ(device.opposite, cpu.opposite);
  }
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerInvariant);
VDWMESH_INSTANTIATE_BACKENDS(RefinerDeterminism);

}  // namespace
}  // namespace vdwmesh::testing
