// Centres, far vertices, coincident and nested spheres, ties; limits, bad meshes, cancellation.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "contract/refiner_contract.hpp"
#include "core/monitor.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerAwkward : public RefinerContract {
 protected:
  std::string limit_message(const IndexedMesh& mesh, const RefineOptions& options) const {
    try {
      refine(one_sphere(1), mesh, options);
    } catch (const LimitExceeded& error) {
      return error.what();
    }
    return "nothing thrown";
  }
};

TEST_P(RefinerAwkward, AVertexAtTheCentreStaysAndIsCounted) {
  // The octahedron's vertex (1, 0, 0) is the sphere's centre: no direction leads to the surface.
  for (const double radius : {1.0, 1.7}) {
    const RefineResult result =
        refine(spheres_of({{{1, 0, 0}, radius}}), octahedron(), refine_options(0, Projection::vdw));
    EXPECT_EQ(result.mesh.positions[0], (Vec3d{1, 0, 0}));
    EXPECT_GE(result.levels[0].unconverged + result.levels[0].out_of_reach, 1u);
    for (const Vec3f& n : result.mesh.normals) EXPECT_NEAR(norm(n), 1, 1e-6);
  }
}

TEST_P(RefinerAwkward, AVertexOfZeroGradientStaysAndIsCounted) {
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    const GridSpec grid{{-3, -3, -3}, 0.5, {12, 12, 12}};
    const RefineResult result =
        refine(spheres_of({{{1, 0, 0}, 1.0}}), octahedron(), field_options(0, kind, grid));
    EXPECT_EQ(result.mesh.positions[0], (Vec3d{1, 0, 0}));
    EXPECT_GE(result.levels[0].unconverged + result.levels[0].out_of_reach, 1u);
    EXPECT_EQ(facts_of(result.mesh).bad_numbers, 0u);
  }
}

TEST_P(RefinerAwkward, FarVerticesStayAndAreCounted) {
  const IndexedMesh far = translated(octahedron(), {100, 0, 0});
  const GridSpec grid{{-3, -3, -3}, 0.5, {12, 12, 12}};
  for (const RefineOptions& options :
       {refine_options(1, Projection::vdw), field_options(1, FieldKind::blinn, grid)}) {
    const RefineResult result = refine(one_sphere(1.7), far, options);
    EXPECT_EQ(result.levels[0].out_of_reach, 6u);
    EXPECT_EQ(result.levels[1].out_of_reach, 12u);
    for (std::size_t v = 0; v < 6; ++v) EXPECT_EQ(result.mesh.positions[v], far.positions[v]);
    EXPECT_EQ(result.mesh.vertex_count(), 18u);
  }
}

TEST_P(RefinerAwkward, NoSpheresPutEverythingOutOfReach) {
  const RefineResult result = refine({}, octahedron(), refine_options(1, Projection::vdw));
  EXPECT_EQ(result.levels[0].out_of_reach, 6u);
  EXPECT_EQ(result.mesh.vertex_spheres[0], on_sphere(kNoSphere));
}

TEST_P(RefinerAwkward, AnEmptyMeshStaysEmpty) {
  const RefineResult result = refine(one_sphere(1), {}, refine_options(3, Projection::vdw));
  EXPECT_EQ(result.mesh.vertex_count(), 0u);
  EXPECT_EQ(result.mesh.triangle_count(), 0u);
  EXPECT_EQ(result.levels.size(), 4u);
}

TEST_P(RefinerAwkward, OfCoincidentSpheresTheLowestOwns) {
  const SphereSet spheres =
      spheres_of({{{5, 0, 0}, 1}, {{0, 0, 0}, 1.5}, {{0, 0, 0}, 1.5}, {{0, 0, 0}, 1.5}});
  const RefineResult result = refine(spheres, octahedron(), refine_options(3, Projection::vdw));
  EXPECT_EQ(left_out(result), 0u);
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v)
    EXPECT_EQ(result.mesh.vertex_spheres[v], on_sphere(1));
}

TEST_P(RefinerAwkward, NestedSpheresAreNotSeen) {
  const SphereSet spheres = spheres_of({{{0.1, 0, 0}, 0.5}, {{0, 0, 0}, 1.5}, {{0, 0.3, 0}, 1.2}});
  const RefineResult result = refine(spheres, octahedron(), refine_options(3, Projection::vdw));
  EXPECT_EQ(left_out(result), 0u);
  for (const Vec3d& p : result.mesh.positions) EXPECT_NEAR(norm(p), 1.5, 1e-9);
  // The third touches the second from inside, in (0, 1.5, 0).
  for (const SphereId atom : result.mesh.vertex_spheres.atoms) EXPECT_NE(atom, 0u);
}

TEST_P(RefinerAwkward, LimitsNameTheirNumbers) {
  RefineOptions options = refine_options(2, Projection::vdw);
  options.memory_limit = 1000;
  const std::string bytes = limit_message(octahedron(), options);
  EXPECT_THAT(bytes, ::testing::HasSubstr("1000"));
  EXPECT_THAT(bytes, ::testing::HasSubstr(std::to_string(refine_bytes(6, 8, 1, 2))));
  // 8 * 4^15 triangles: 4 * 4^15 + 2 vertices, more than 2^32.
  const std::string count = limit_message(octahedron(), refine_options(15, Projection::vdw));
  EXPECT_THAT(count, ::testing::HasSubstr("4294967298 vertices"));
  EXPECT_THAT(count, ::testing::HasSubstr("4294967296"));
}

TEST_P(RefinerAwkward, SubdivisionsOutOfRangeAreInvalid) {
  for (const int subdivisions : {-1, 40}) {
    EXPECT_THROW(refine(one_sphere(1), octahedron(), refine_options(subdivisions, Projection::vdw)),
                 InvalidInput);
  }
}

TEST_P(RefinerAwkward, MeshesThatAreNotClosedAreInvalid) {
  const RefineOptions once = refine_options(1, Projection::none);
  for (const IndexedMesh& mesh :
       {disc(4), flat_ring(), mobius_strip(12), tetrahedra_sharing_edge()}) {
    EXPECT_THROW(refine({}, mesh, once), InvalidInput);
  }
}

TEST_P(RefinerAwkward, BrokenArraysAreInvalid) {
  const RefineOptions once = refine_options(1, Projection::vdw);
  const auto expect_invalid = [&](auto&& spoil) {
    IndexedMesh mesh = octahedron();
    spoil(mesh);
    EXPECT_THROW(refine(one_sphere(1), mesh, once), InvalidInput);
  };
  expect_invalid([](IndexedMesh& m) { m.triangles[3][1] = 6; });
  expect_invalid([](IndexedMesh& m) { m.triangles[3][1] = m.triangles[3][0]; });
  expect_invalid([](IndexedMesh& m) { m.positions[2].y = std::nan(""); });
  expect_invalid([](IndexedMesh& m) { m.normals.assign(5, {0, 0, 1}); });
  expect_invalid([](IndexedMesh& m) { m.opposite.assign(24, 0); });
  expect_invalid([](IndexedMesh& m) { m.opposite.assign(3, 0); });
  expect_invalid([](IndexedMesh& m) { m.vertex_spheres.assign(6, on_sphere(1)); });
}

// Grids that look for crossings count cells in single precision, which ends at 3.4e38.
TEST_P(RefinerAwkward, AVertexFartherThanAnySphereIsInvalid) {
  for (const double far : {1.0000001e30, 1e39, 1e300, std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    IndexedMesh mesh = octahedron();
    mesh.positions[2].y = -far;
    EXPECT_THROW(refine(one_sphere(1), mesh, refine_options(1, Projection::vdw)), InvalidInput);
  }
}

TEST_P(RefinerAwkward, TheFieldNeedsABlendedFieldAndItsGrid) {
  const GridSpec grid{{-3, -3, -3}, 0.5, {12, 12, 12}};
  EXPECT_THROW(refine(one_sphere(1), octahedron(), field_options(0, FieldKind::vdw, grid)),
               InvalidInput);
  EXPECT_THROW(refine(one_sphere(1), octahedron(), field_options(0, FieldKind::blinn, {})),
               InvalidInput);
}

class Stop : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

TEST_P(RefinerAwkward, StopsOnRequest) {
  Stop stop;
  RefineOptions options = refine_options(2, Projection::vdw);
  options.monitor = &stop;
  EXPECT_THROW(refine(one_sphere(1), octahedron(), options), Cancelled);
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerAwkward);

}  // namespace
}  // namespace vdwmesh::testing
