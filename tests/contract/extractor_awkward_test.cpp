// Input that breaks marching cubes programs.
#include <cmath>
#include <limits>
#include <numbers>

#include "contract/extractor_contract.hpp"
#include "core/monitor.hpp"
#include "reference/closed_forms.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorAwkward : public ExtractorContract {};
class ExtractorFieldAwkward : public ExtractorFieldContract {};

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST_P(ExtractorFieldAwkward, NoSpheresIsInvalidInput) {
  EXPECT_THROW(extract(SphereSet(), at_spacing(0.5)), InvalidInput);
}

TEST_P(ExtractorFieldAwkward, OptionsOutsideTheContractAreInvalidInput) {
  for (const double spacing : {0.0, -0.5, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(extract(one_sphere(1), at_spacing(spacing)), InvalidInput) << spacing;
  }
  for (const double padding : {-1.0, kNaN}) {
    ExtractOptions options = at_spacing(0.5);
    options.grid.padding = padding;
    EXPECT_THROW(extract(one_sphere(1), options), InvalidInput) << padding;
  }
  for (const double isovalue : {0.0, -1.0, kNaN}) {
    ExtractOptions options = at_spacing(0.5);
    options.field.isovalue = isovalue;
    EXPECT_THROW(extract(one_sphere(1), options), InvalidInput) << isovalue;
  }
}

TEST_P(ExtractorAwkward, VdwTakesNoFieldParameters) {
  ExtractOptions options;
  options.field.isovalue = 1;
  EXPECT_THROW(extract(one_sphere(1), options), InvalidInput);
  options.field = {FieldKind::vdw, FieldPreset::radius_aware, {}, 2.0};
  EXPECT_THROW(extract(one_sphere(1), options), InvalidInput);
  options.field = {FieldKind::vdw, FieldPreset::thesis, {}, {}};
  EXPECT_THROW(extract(one_sphere(1), options), InvalidInput);
}

SphereSet spheres_of(std::initializer_list<Sphere> list) { return SphereSet(std::vector(list)); }

struct Named {
  const char* name;
  SphereSet spheres;
};

std::vector<Named> awkward_sets() {
  const double g = std::numbers::phi;
  std::vector<Named> sets{
      {"one", one_sphere(1.7)},
      {"two apart", two_spheres(1.5, 1.5, 8)},
      {"coincident", spheres_of({{{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.7}})},
      {"concentric", spheres_of({{{0, 0, 0}, 1.7}, {{0, 0, 0}, 1.2}})},
      {"nested", spheres_of({{{0, 0, 0}, 2}, {{0.3, 0.2, 0.1}, 1}})},
      {"tangent from inside", spheres_of({{{0, 0, 0}, 2}, {{1, 0, 0}, 1}})},
      {"tangent along x", spheres_of({{{-1.5, 0, 0}, 1.5}, {{1.5, 0, 0}, 1.5}})},
      {"tangent across", two_spheres(1.4, 2.1, 3.5)},
      {"three in a row, tangent", spheres_of({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{4, 0, 0}, 1}})},
  };
  std::vector<Sphere> cube, icosahedron;
  for (int c = 0; c < 8; ++c) {
    cube.push_back({{c & 1 ? 1. : -1., c & 2 ? 1. : -1., c & 4 ? 1. : -1.}, std::sqrt(3.0)});
  }
  for (int c = 0; c < 4; ++c) {
    const double a = c & 1 ? 1 : -1, b = c & 2 ? g : -g;
    for (const Vec3d& p : {Vec3d{0, a, b}, Vec3d{a, b, 0}, Vec3d{b, 0, a}}) {
      icosahedron.push_back({p, 1.5});
    }
  }
  sets.push_back({"cube through its centre", SphereSet(cube)});
  sets.push_back({"icosahedron", SphereSet(icosahedron)});
  return sets;
}

TEST_P(ExtractorFieldAwkward, EverySetMakesASoundMesh) {
  for (const Named& set : awkward_sets()) {
    for (const double h : {0.25, 0.5, 1.0}) {
      expect_sound(extract(set.spheres, at_spacing(h)),
                   std::string(set.name) + " at " + std::to_string(h));
    }
  }
}

// Centres, radii and padding are whole multiples of the spacing, so that centres sit on nodes,
// spheres touch grid planes, and nodes at (3, 4, 0), (5, 0, 0) ... lie on the sphere exactly: field
// values are T there, and distances are r.
TEST_P(ExtractorFieldAwkward, SurfaceThroughNodesMakesNoCrack) {
  for (const double h : {0.25, 0.5, 0.4}) {
    for (const int padding : {1, 2, 3}) {
      ExtractOptions options = at_spacing(h);
      options.grid.padding = padding * h;
      const std::string what = "spacing " + std::to_string(h);
      expect_sound(extract(spheres_of({{{0, 0, 0}, 5 * h}}), options), what + ", r = 5 h");
      expect_sound(extract(spheres_of({{{0, 0, 0}, 3 * h}, {{6 * h, 0, 0}, 3 * h}}), options),
                   what + ", two touch at a node");
      expect_sound(extract(spheres_of({{{0, 0, 0}, 5 * h}, {{3 * h, 4 * h, 0}, 5 * h}}), options),
                   what + ", two overlap");
      expect_sound(extract(spheres_of({{{0, 0, 0}, h}}), options), what + ", r = h");
    }
  }
}

TEST_P(ExtractorFieldAwkward, SurfaceCutByTheBorderIsClosedAndCounted) {
  for (const double h : {0.3, 0.5}) {
    ExtractOptions options = at_spacing(h);
    options.grid.box = GridBox::centers;
    options.grid.padding = 0.7;
    const ExtractResult result = extract(cluster(30, 6), options);
    expect_sound(result, "cut by the border");
    EXPECT_GT(result.stats.grid_clipped, 0u);
    if (kind() != FieldKind::vdw) continue;
    EXPECT_EQ(extract(cluster(30, 6), at_spacing(h)).stats.grid_clipped, 0u);
  }
}

TEST_P(ExtractorFieldAwkward, NoPaddingAtAllIsClosed) {
  ExtractOptions options = at_spacing(0.5);
  options.grid.padding = 0;
  for (const Named& set : awkward_sets()) {
    expect_sound(extract(set.spheres, options), std::string(set.name) + ", no padding");
  }
}

TEST_P(ExtractorAwkward, AFlatGridIsClosed) {
  // All centres in a plane and no padding around the centres: one layer of nodes, or one cell.
  ExtractOptions options;
  options.grid.box = GridBox::centers;
  options.grid.padding = 0;
  const SphereSet plate = spheres_of({{{0, 0, 0}, 2}, {{3, 0, 0}, 2}, {{0, 3, 0}, 2}});
  const ExtractResult result = extract(plate, options);
  expect_sound(result, "flat");
  EXPECT_GT(result.stats.grid_clipped, 0u);
  expect_sound(extract(one_sphere(2), options), "a single node or cell");
}

// A row of spheres in a grid of n bricks: 5 cells across are 8 lattice nodes with the virtual layer
// on both sides, one brick; n bricks along hold 8 n - 3 cells.
TEST_P(ExtractorFieldAwkward, BrickCountsAroundTheWarp) {
  for (const int bricks : {1, 2, 31, 32, 33}) {
    ExtractOptions options = at_spacing(0.5);
    options.grid.padding = 0.25;
    const double length = 4 * bricks - 4;
    std::vector<Sphere> row;
    for (int i = 0; i <= length; ++i) row.push_back({{static_cast<double>(i), 0, 0}, 1});
    const ExtractResult result = extract(SphereSet(row), options);
    EXPECT_EQ(result.grid.cells.x, 8 * bricks - 3);
    EXPECT_EQ(result.grid.cells.y, 5);
    EXPECT_EQ(result.stats.surface_bricks, static_cast<std::uint64_t>(bricks));
    expect_sound(result, std::to_string(bricks) + " bricks");
    EXPECT_EQ(facts_of(result).euler_characteristic(), 2);
  }
}

TEST_P(ExtractorFieldAwkward, GridSizesAroundABrick) {
  for (int cells = 1; cells <= 19; ++cells) {
    ExtractOptions options = at_spacing(0.4);
    options.grid.padding = 0;
    const double radius = (0.4 * cells - 0.1) / 2;
    const ExtractResult result = extract(one_sphere(radius), options);
    ASSERT_EQ(result.grid.cells.x, cells);
    // Of one cell, all nodes are corners of a cube around the sphere. Of two, the node in the
    // middle is 0.05 Å from the centre along each axis, and the radius is 0.35 Å.
    if (cells == 1) {
      EXPECT_EQ(result.mesh.triangle_count(), 0u);
    } else {
      expect_sound(result, std::to_string(cells) + " cells");
    }
  }
}

TEST_P(ExtractorFieldAwkward, SpheresMuchSmallerThanTheSpacing) {
  // Alone it passes between the nodes: no mesh, no crash. The nearest node is 0.01 Å from the
  // centre along each axis, so 0.017 Å away.
  const ExtractResult lost = extract(one_sphere(0.01), at_spacing(0.5));
  EXPECT_EQ(lost.mesh.triangle_count(), 0u);
  // On a node it is an octahedron.
  ExtractOptions options = at_spacing(0.5);
  options.grid.box = GridBox::centers;
  options.grid.padding = 1;
  const ExtractResult found = extract(one_sphere(0.01), options);
  expect_sound(found, "tiny, on a node");
  EXPECT_EQ(found.mesh.vertex_count(), 6u);
  EXPECT_EQ(found.mesh.triangle_count(), 8u);
}

TEST_P(ExtractorFieldAwkward, OneHugeAndManyTiny) {
  std::vector<Sphere> spheres{{{0, 0, 0}, 15}};
  const SphereSet dust = hollow_shell(400, 15.05, 0.25);
  spheres.insert(spheres.end(), dust.spheres().begin(), dust.spheres().end());
  const ExtractResult result = extract(SphereSet(spheres), at_spacing(0.5));
  expect_sound(result, "one huge and many tiny");
  if (kind() == FieldKind::vdw) {
    // The dust adds less than 400 half balls.
    const double volume = facts_of(result).volume;
    EXPECT_GT(volume, 0.995 * reference::ball(15).volume);
    EXPECT_LT(volume, reference::ball(15).volume + 400 * reference::ball(0.25).volume);
  }
}

// 20,000 cells along each axis are 8e12 nodes; the surface is two spheres.
TEST_P(ExtractorFieldAwkward, CostGrowsWithTheSurfaceNotWithTheBox) {
  const SphereSet far = spheres_of({{{0, 0, 0}, 1.7}, {{1e4, 1e4, 1e4}, 1.7}});
  const ExtractResult result = extract(far, at_spacing(0.5));
  expect_sound(result, "far apart");
  EXPECT_EQ(facts_of(result).positive_shells, 2u);
  EXPECT_LT(result.stats.surface_bricks, 100u);
}

TEST_P(ExtractorAwkward, LimitsAreCheckedBeforeMemoryIsTaken) {
  ExtractOptions options;
  EXPECT_THROW(extract(spheres_of({{{0, 0, 0}, 1}, {{1e6, 0, 0}, 1}}), options), LimitExceeded);
  options.memory_limit = 1000;  // bytes
  EXPECT_THROW(extract(cluster(50, 1), options), LimitExceeded);
}

class Stop : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

TEST_P(ExtractorAwkward, StopsOnRequest) {
  Stop stop;
  ExtractOptions options;
  options.monitor = &stop;
  EXPECT_THROW(extract(cluster(50, 1), options), Cancelled);
}

TEST_P(ExtractorFieldAwkward, LeavesNormalsOutAlone) {
  ExtractOptions options = at_spacing(0.5);
  const IndexedMesh whole = extract(cluster(50, 1), options).mesh;
  options.normals = Normals::none;
  const IndexedMesh mesh = extract(cluster(50, 1), options).mesh;
  EXPECT_EQ(whole.normals.size(), whole.vertex_count());
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(mesh.positions, whole.positions);
  EXPECT_EQ(mesh.vertex_spheres, whole.vertex_spheres);
  EXPECT_EQ(mesh.triangles, whole.triangles);
}

// Nor does a refinement need them, whose own are those of the surface it projects to.
TEST_P(ExtractorAwkward, RefinesWithoutNormals) {
  RefineOptions refine;
  refine.subdivisions = 1;
  ExtractOptions options;
  const auto mesh_of = [&] {
    return make_pipeline(GetParam())->run(cluster(20, 1), options, refine).mesh;
  };
  const IndexedMesh whole = mesh_of();
  options.normals = Normals::none;
  const IndexedMesh mesh = mesh_of();
  EXPECT_EQ(mesh.positions, whole.positions);
  EXPECT_EQ(mesh.normals, whole.normals);
  refine.projection = Projection::none;
  EXPECT_TRUE(mesh_of().normals.empty());
}

TEST_P(ExtractorAwkward, TellsTheSizeBeforeTheMeshIsMade) {
  std::vector<MeshSize> told;
  ExtractOptions options;
  options.on_size = [&](const MeshSize& size) { told.push_back(size); };
  const ExtractResult result = extract(cluster(50, 1), options);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].vertices, result.mesh.vertex_count());
  EXPECT_EQ(told[0].triangles, result.mesh.triangle_count());
  options.on_size = [](const MeshSize&) { throw Cancelled("no room"); };
  EXPECT_THROW(extract(cluster(50, 1), options), Cancelled);
}

// With subdivisions it is the refined mesh whose size is told.
TEST_P(ExtractorAwkward, ThePipelineTellsTheSizeOfItsMesh) {
  for (const int subdivisions : {0, 1, 2}) {
    std::vector<MeshSize> told;
    ExtractOptions options;
    options.on_size = [&](const MeshSize& size) { told.push_back(size); };
    RefineOptions refine;
    refine.subdivisions = subdivisions;
    const IndexedMesh mesh = make_pipeline(GetParam())->run(cluster(20, 1), options, refine).mesh;
    ASSERT_EQ(told.size(), 1u) << subdivisions;
    EXPECT_EQ(told[0].vertices, mesh.vertex_count()) << subdivisions;
    EXPECT_EQ(told[0].triangles, mesh.triangle_count()) << subdivisions;
  }
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorAwkward);
VDWMESH_INSTANTIATE_FIELDS(ExtractorFieldAwkward);

}  // namespace
}  // namespace vdwmesh::testing
