// Fields that stand in memory: their values, their meshes, and that both are the Extractor's.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "extract/sampled_field.hpp"
#include "reference/dense_mc.hpp"
#include "support/sampled_spheres.hpp"

namespace vdwmesh::testing {
namespace {

class FieldMesherContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  std::unique_ptr<FieldMesher> mesher() const { return make_field_mesher(GetParam()); }
};

constexpr FieldKind kBlended[] = {FieldKind::blinn, FieldKind::soft_object,
                                  FieldKind::inverse_squared};

ExtractOptions options_of(FieldKind kind, double spacing) {
  ExtractOptions options;
  options.field.kind = kind;
  options.grid.spacing = spacing;
  options.connectivity = Connectivity::half_edges;
  return options;
}

// `Field`: a SampledField, const or not.
template <class Field>
auto& value_at(Field& field, std::int64_t i, std::int64_t j, std::int64_t k) {
  const Vec3i& cells = field.grid.cells;
  return field.values[static_cast<std::size_t>((k * (cells.y + 1) + j) * (cells.x + 1) + i)];
}

// A field of the caller's: values(position) at every node.
template <class Values>
SampledField sampled(const Vec3i& cells, double spacing, float isovalue, Values values) {
  SampledField field{{{-1.1, 0.7, 2.3}, spacing, cells}, {}, isovalue};
  field.values.resize(field.grid.node_count());
  for (std::int64_t k = 0; k <= cells.z; ++k) {
    for (std::int64_t j = 0; j <= cells.y; ++j) {
      for (std::int64_t i = 0; i <= cells.x; ++i) {
        value_at(field, i, j, k) = values(Vec3d{node_coordinate(field.grid.origin.x, spacing, i),
                                                node_coordinate(field.grid.origin.y, spacing, j),
                                                node_coordinate(field.grid.origin.z, spacing, k)});
      }
    }
  }
  return field;
}

// float32 sums of some dozens of terms of a few T: as in extractor_reference_test.cpp.
constexpr double kValueTolerance = 2e-5;

TEST_P(FieldMesherContract, RefusesGridsAndIsovaluesThatAreNone) {
  const SampledField good =
      sampled({6, 5, 4}, 0.5, 1.0f, [](const Vec3d& p) { return static_cast<float>(4 - norm(p)); });
  EXPECT_NO_THROW((void)mesher()->mesh(good, {}));
  const auto refused = [&](const auto& change) {
    SampledField field = good;
    change(field);
    EXPECT_THROW((void)mesher()->mesh(field, {}), InvalidInput);
  };
  refused([](SampledField& f) { f.grid.cells.y = -2; });
  refused([](SampledField& f) {
    f.grid.cells = {-2, -2, 209};
  });  // as many nodes, by their product
  refused([](SampledField& f) { f.grid.spacing = 0; });
  refused([](SampledField& f) { f.grid.spacing = std::numeric_limits<double>::quiet_NaN(); });
  refused([](SampledField& f) { f.grid.origin.z = std::numeric_limits<double>::infinity(); });
  refused([](SampledField& f) { f.isovalue = std::numeric_limits<float>::quiet_NaN(); });
}

TEST_P(FieldMesherContract, RefusesMoreCellsThanKeysNumber) {
  SampledField field = sampled({0, 0, 0}, 0.5, 1.0f, [](const Vec3d&) { return 0.0f; });
  field.grid.cells.x = kMaxCellsPerAxis + 1;
  field.values.resize(field.grid.node_count());
  EXPECT_THROW((void)mesher()->mesh(field, {}), LimitExceeded);
  field.grid.cells.x = kMaxCellsPerAxis;
  field.values.resize(field.grid.node_count());
  std::fill(field.values.begin(), field.values.end(), 0.0f);
  field.values[field.values.size() - 3] = 2.0f;
  EXPECT_EQ(mesher()->mesh(field, {}).mesh.triangle_count(), 8u);  // an octahedron about one node
}

TEST_P(FieldMesherContract, ValuesAreTheOracles) {
  for (const FieldKind kind : kBlended) {
    const SphereSet spheres = cluster(30, 5);
    const ExtractOptions options = options_of(kind, 0.6);
    SampledField field = sampled_spheres(spheres, options);
    const auto oracle = to_oracle(options.field, field.grid);
    const auto balls = to_balls(spheres);
    const reference::DenseGrid dense{to_point(field.grid.origin),
                                     field.grid.spacing,
                                     {field.grid.cells.x, field.grid.cells.y, field.grid.cells.z}};
    for (std::int64_t k = 0; k <= field.grid.cells.z; ++k) {
      for (std::int64_t j = 0; j <= field.grid.cells.y; ++j) {
        for (std::int64_t i = 0; i <= field.grid.cells.x; ++i) {
          const double exact =
              reference::sample_field(oracle, balls, dense.position({i, j, k})).value;
          const double error = std::abs(static_cast<double>(value_at(field, i, j, k)) - exact);
          // 1/d^2 grows without bound towards an atom: relative there.
          ASSERT_LE(error, kValueTolerance * std::max(1.0, exact / 4))
              << field_name(kind) << ' ' << i << ' ' << j << ' ' << k;
        }
      }
    }
  }
}

TEST_P(FieldMesherContract, MeshOfTheSamplesIsTheExtractors) {
  for (const FieldKind kind : kBlended) {
    for (const double spacing : {0.3, 0.8}) {
      const SphereSet spheres = cluster(60, 8);
      const ExtractOptions options = options_of(kind, spacing);
      const ExtractResult direct = make_extractor(GetParam())->extract(spheres, options);
      ASSERT_EQ(direct.stats.grid_clipped, 0u);
      const ExtractResult ours = mesher()->mesh(sampled_spheres(spheres, options), options);
      EXPECT_EQ(ours.mesh.positions, direct.mesh.positions) << field_name(kind);
      EXPECT_EQ(ours.mesh.triangles, direct.mesh.triangles) << field_name(kind);
      EXPECT_EQ(ours.mesh.opposite, direct.mesh.opposite) << field_name(kind);
      EXPECT_EQ(ours.stats.surface_bricks, direct.stats.surface_bricks);
      EXPECT_TRUE(ours.mesh.vertex_spheres.empty());
    }
  }
}

// Linear interpolation and central differences are exact for a plane, up to float32 values.
TEST_P(FieldMesherContract, LeavesNormalsOutAndTellsTheSize) {
  ExtractOptions options = options_of(FieldKind::blinn, 0.5);
  const SampledField field = sampled_spheres(cluster(60, 8), options);
  const IndexedMesh whole = mesher()->mesh(field, options).mesh;
  std::vector<MeshSize> told;
  options.normals = Normals::none;
  options.on_size = [&](const MeshSize& size) { told.push_back(size); };
  const IndexedMesh mesh = mesher()->mesh(field, options).mesh;
  EXPECT_EQ(whole.normals.size(), whole.vertex_count());
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(mesh.positions, whole.positions);
  EXPECT_EQ(mesh.triangles, whole.triangles);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].vertices, mesh.vertex_count());
  EXPECT_EQ(told[0].triangles, mesh.triangle_count());
}

TEST_P(FieldMesherContract, APlaneIsExact) {
  const Vec3d n{2.0 / 7, 3.0 / 7, 6.0 / 7};
  const Vec3d through{1.0, 2.5, 4.0};
  const SampledField field = sampled({20, 19, 18}, 0.25, 0.5f, [&](const Vec3d& p) {
    return static_cast<float>(0.5 - dot(n, p - through));
  });
  const ExtractResult result = mesher()->mesh(field, {});
  ASSERT_GT(result.mesh.vertex_count(), 0u);
  EXPECT_GT(result.stats.grid_clipped, 0u);
  std::size_t on_plane = 0;
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    // Values below 8, so good to 2^-21, an edge changes them by 0.07 at least.
    if (std::abs(dot(n, result.mesh.positions[v] - through)) > 1e-5) continue;
    ++on_plane;
    EXPECT_LE(norm(cast<double>(result.mesh.normals[v]) - n), 1e-4) << v;
  }
  EXPECT_GT(on_plane, 400u);  // a cut of a box of 20 x 19 x 18 cells, whatever its direction
}

// Central differences of a quadratic are its gradient, which is linear along an edge: normals point
// away from the centre, whatever the spacing.
TEST_P(FieldMesherContract, NormalsOfAQuadraticAreRadial) {
  const Vec3d centre{1.2, 3.1, 4.5};
  const SampledField field = sampled({10, 10, 10}, 0.5, -2.0f, [&](const Vec3d& p) {
    return static_cast<float>(-squared_norm(p - centre));
  });
  const IndexedMesh mesh = mesher()->mesh(field, {}).mesh;
  ASSERT_GT(mesh.vertex_count(), 100u);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d away = mesh.positions[v] - centre;
    ASSERT_LE(norm(cast<double>(mesh.normals[v]) - (1 / norm(away)) * away), 1e-5) << v;
  }
}

TEST_P(FieldMesherContract, NoiseIsMeshedLikeDenseMarchingCubes) {
  std::mt19937 random(3);
  for (const std::int64_t cells : {1, 7, 8, 31, 33}) {
    std::uniform_real_distribution<float> noise(-1, 1);
    const SampledField field =
        sampled({cells, 9, 12}, 0.5, 0, [&](const Vec3d&) { return noise(random); });
    const ExtractResult result = mesher()->mesh(field, {});
    const reference::DenseGrid dense{
        to_point(field.grid.origin), field.grid.spacing, {cells, 9, 12}};
    const auto expected = reference::dense_marching_cubes(
        dense, [&](const reference::Node& n) { return value_at(field, n[0], n[1], n[2]) >= 0; },
        [](const reference::Point& a, const reference::Point& b) { return 0.5 * (a + b); });
    EXPECT_EQ(result.mesh.vertex_count(), expected.mesh.points.size()) << cells;
    EXPECT_EQ(result.mesh.triangle_count(), expected.mesh.triangles.size()) << cells;
    EXPECT_TRUE(facts_of(result).closed_oriented_manifold()) << cells;
  }
}

TEST_P(FieldMesherContract, NotANumberIsOutside) {
  SampledField field = sampled(
      {9, 9, 9}, 0.5, 0, [](const Vec3d&) { return std::numeric_limits<float>::quiet_NaN(); });
  EXPECT_EQ(mesher()->mesh(field, {}).mesh.vertex_count(), 0u);
  value_at(field, 4, 5, 6) = 1;
  const ExtractResult one = mesher()->mesh(field, {});
  EXPECT_EQ(one.mesh.vertex_count(), 6u);  // an octahedron
  EXPECT_EQ(one.mesh.triangle_count(), 8u);
}

VDWMESH_INSTANTIATE_BACKENDS(FieldMesherContract);

}  // namespace
}  // namespace vdwmesh::testing
