// Against the slow oracle: the same grid edges, and every vertex where the surface is.
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "contract/extractor_contract.hpp"
#include "reference/dense_mc.hpp"
#include "support/worst.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorReference : public ExtractorContract {};
class ExtractorFieldReference : public ExtractorFieldContract {};

using reference::Ball;
using reference::GridEdge;
using reference::Point;

constexpr double kOnSurface = 1e-9;  // Å, what the handbook promises of vdw vertices
constexpr double kClampParameter = 1.0 / (1 << 20);  // of an edge

reference::DenseGrid to_dense(const GridSpec& grid) {
  return {to_point(grid.origin), grid.spacing, {grid.cells.x, grid.cells.y, grid.cells.z}};
}

// The grid edge on which p lies: two coordinates on grid planes, one between. Positions are good to
// 1e-12 Å, and a vertex keeps off the nodes by 2^-20 of an edge.
std::optional<GridEdge> edge_of(const GridSpec& grid, const Vec3d& p) {
  GridEdge edge{{0, 0, 0}, -1};
  for (int a = 0; a < 3; ++a) {
    const double place = (p[a] - grid.origin[a]) / grid.spacing;
    const double nearest = std::round(place);
    const bool between = std::abs(place - nearest) > 1e-9;
    if (between && edge.axis >= 0) return std::nullopt;
    if (between) edge.axis = a;
    edge.node[static_cast<std::size_t>(a)] =
        static_cast<std::int64_t>(between ? std::floor(place) : nearest);
  }
  if (edge.axis < 0) return std::nullopt;
  return edge;
}

std::set<GridEdge> edges_of(const ExtractResult& result) {
  std::set<GridEdge> edges;
  for (const Vec3d& p : result.mesh.positions) {
    const auto edge = edge_of(result.grid, p);
    EXPECT_TRUE(edge) << p.x << ' ' << p.y << ' ' << p.z << " lies on no grid edge";
    if (edge) edges.insert(*edge);
  }
  EXPECT_EQ(edges.size(), result.mesh.vertex_count()) << "two vertices on one grid edge";
  return edges;
}

std::set<GridEdge> edges_of(const reference::DenseMesh& dense) {
  std::set<GridEdge> edges;
  for (const auto& [edge, vertex] : dense.vertex_of_edge) edges.insert(edge);
  return edges;
}

// How far inside a point is, in the field's own unit: positive inside.
class Oracle {
 public:
  Oracle(const SphereSet& spheres, const FieldOptions& field, const GridSpec& grid)
      : balls_(to_balls(spheres)), kind_(field.kind), field_(to_oracle(field, grid)) {
    isovalue_ = field.isovalue.value_or(reference::default_isovalue(field_));
  }
  double depth(const Point& p) const {
    if (kind_ == FieldKind::vdw) return -reference::sample_union(balls_, p).signed_distance;
    return reference::sample_field(field_, balls_, p).value - isovalue_;
  }
  bool inside(const Point& p) const { return depth(p) >= 0; }
  Point gradient(const Point& p) const {
    return reference::sample_field(field_, balls_, p).gradient;
  }
  const std::vector<Ball>& balls() const { return balls_; }

 private:
  std::vector<Ball> balls_;
  FieldKind kind_;
  reference::FieldOracle field_;
  double isovalue_ = 1;
};

// Nodes whose sign single precision (or the last bit of a double) could turn. Fields are sums of at
// most some dozens of float32 terms: 64 · 2^-24 of a field of a few T.
double sign_margin(FieldKind kind) { return kind == FieldKind::vdw ? 1e-12 : 2e-5; }

reference::DenseMesh dense_mesh(const Oracle& oracle, const GridSpec& grid, FieldKind kind,
                                std::size_t* undecided) {
  const reference::DenseGrid dense = to_dense(grid);
  const auto inside = [&](const reference::Node& node) {
    const double depth = oracle.depth(dense.position(node));
    if (std::abs(depth) < sign_margin(kind)) ++*undecided;
    return depth >= 0;
  };
  const auto middle = [](const Point& a, const Point& b) { return 0.5 * (a + b); };
  return reference::dense_marching_cubes(dense, inside, middle);
}

TEST_P(ExtractorFieldReference, MeshIsThatOfDenseMarchingCubes) {
  for (const unsigned seed : {3u, 4u, 9u}) {
    const SphereSet spheres = cluster(40, seed);
    const ExtractOptions options = at_spacing(0.4);
    const ExtractResult result = extract(spheres, options);
    const Oracle oracle(spheres, options.field, result.grid);
    std::size_t undecided = 0;
    const auto dense = dense_mesh(oracle, result.grid, kind(), &undecided);
    ASSERT_EQ(undecided, 0u) << "choose another seed than " << seed;
    const std::set<GridEdge> ours = edges_of(result), theirs = edges_of(dense);
    EXPECT_EQ(ours, theirs) << "seed " << seed;
    EXPECT_EQ(result.mesh.triangle_count(), dense.mesh.triangles.size());
  }
}

// The thesis's presets: one blob size, sub-grids around the atoms' cells.
TEST_P(ExtractorReference, ThesisPresetsAreThoseOfDenseMarchingCubes) {
  const std::pair<FieldKind, FieldPreset> cases[] = {
      {FieldKind::blinn, FieldPreset::thesis},
      {FieldKind::soft_object, FieldPreset::thesis},
      {FieldKind::inverse_squared, FieldPreset::thesis},
      {FieldKind::inverse_squared, FieldPreset::thesis_vdw}};
  for (const auto& [kind, preset] : cases) {
    std::size_t compared = 0;
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const SphereSet spheres = cluster(40, seed);
      ExtractOptions options;
      options.field.kind = kind;
      options.field.preset = preset;
      options.grid = preset_grid(preset, {}, {});
      const ExtractResult result = extract(spheres, options);
      expect_sound(result, field_name(kind));
      const Oracle oracle(spheres, options.field, result.grid);
      std::size_t undecided = 0;
      const auto dense = dense_mesh(oracle, result.grid, kind, &undecided);
      if (undecided > 0) continue;
      ++compared;
      EXPECT_EQ(edges_of(result), edges_of(dense)) << field_name(kind) << ", seed " << seed;
      EXPECT_EQ(result.mesh.triangle_count(), dense.mesh.triangles.size());
    }
    EXPECT_GE(compared, 2u) << "too many nodes at the isovalue; choose other seeds";
  }
}

TEST_P(ExtractorReference, EveryVdwVertexLiesOnTheUnionsBoundary) {
  for (const double h : {0.25, 0.5, 0.9}) {
    const SphereSet spheres = cluster(150, 21);
    ExtractOptions options;
    options.grid.spacing = h;
    const ExtractResult result = extract(spheres, options);
    const auto balls = to_balls(spheres);
    std::size_t off = 0;
    for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
      const Point p = to_point(result.mesh.positions[v]);
      const double away = std::abs(reference::sample_union(balls, p).signed_distance);
      if (!(away <= kOnSurface)) ++off;
      ASSERT_LE(away, kOnSurface + h * kClampParameter);
    }
    EXPECT_LE(off, result.stats.clamped_vertices);
  }
}

TEST_P(ExtractorReference, AVertexLiesOnTheSpheresItNames) {
  const SphereSet spheres = cluster(150, 22);
  const ExtractResult result = extract(spheres, {});
  const double clamp = result.grid.spacing * kClampParameter;
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const VertexSpheres on = result.mesh.vertex_spheres[v];
    ASSERT_LT(on[0], spheres.size());
    for (const SphereId id : on) {
      if (id == kNoSphere) continue;
      const double d = norm(result.mesh.positions[v] - spheres[id].center) - spheres[id].radius;
      ASSERT_NEAR(d, 0, kOnSurface + clamp) << "vertex " << v;
    }
  }
}

// From its inside node to the vertex all is covered; just beyond the vertex it is not.
TEST_P(ExtractorReference, AVdwVertexIsTheFirstExitFromItsInsideNode) {
  const SphereSet spheres = cluster(100, 23);
  ExtractOptions options;
  options.grid.spacing = 0.8;  // long edges, several exits on one
  const ExtractResult result = extract(spheres, options);
  const Oracle oracle(spheres, options.field, result.grid);
  const reference::DenseGrid grid = to_dense(result.grid);
  for (const Vec3d& position : result.mesh.positions) {
    const auto edge = edge_of(result.grid, position);
    ASSERT_TRUE(edge);
    reference::Node other = edge->node;
    ++other[static_cast<std::size_t>(edge->axis)];
    Point in = grid.position(edge->node), out = grid.position(other);
    if (!oracle.inside(in)) std::swap(in, out);
    ASSERT_TRUE(oracle.inside(in) && !oracle.inside(out));
    const Point p = to_point(position);
    for (int i = 0; i < 64; ++i) {
      ASSERT_GE(oracle.depth(in + (i / 64.) * (p - in)), -kOnSurface);
    }
    const Point beyond = p + (1e-6 / reference::distance(in, out)) * (out - in);
    ASSERT_LT(oracle.depth(beyond), kOnSurface);
  }
}

// Linear interpolation of F on an edge errs by at most h²/8 max|F''|, so that is how far F at the
// vertex is from T; the nodes' float32 values add sign_margin; a clamped parameter adds its share
// of the difference between the nodes.
TEST_P(ExtractorFieldReference, BlendedVerticesAreWithinTheInterpolationBound) {
  if (kind() == FieldKind::vdw) GTEST_SKIP() << "exact intersections; has its own tests";
  const SphereSet spheres = cluster(40, 31);
  const ExtractOptions options = at_spacing(0.35);
  const ExtractResult result = extract(spheres, options);
  const Oracle oracle(spheres, options.field, result.grid);
  const reference::DenseGrid grid = to_dense(result.grid);
  for (const Vec3d& position : result.mesh.positions) {
    const auto edge = edge_of(result.grid, position);
    ASSERT_TRUE(edge);
    reference::Node other = edge->node;
    ++other[static_cast<std::size_t>(edge->axis)];
    const Point a = grid.position(edge->node), b = grid.position(other);
    const int pieces = 32;
    const auto at = [&](int i) { return oracle.depth(a + (double(i) / pieces) * (b - a)); };
    double bend = 0;  // max |F''| h²
    for (int i = 1; i < pieces; ++i) {
      bend = worst(bend, std::abs(at(i - 1) - 2 * at(i) + at(i + 1)) * pieces * pieces);
    }
    // Second differences see the curvature between samples up to a tenth.
    const double bound =
        1.1 * bend / 8 + sign_margin(kind()) + kClampParameter * std::abs(at(0) - at(pieces));
    ASSERT_LE(std::abs(oracle.depth(to_point(position))), bound);
  }
}

// Angle between the stored normal (float32) and the oracle's gradient.
constexpr double kNormalTolerance = 2e-5;  // rad; some float32 roundings of a unit vector

double normal_error(const IndexedMesh& mesh, std::size_t v, const Point& outward) {
  const Point unit = (1 / reference::length(outward)) * outward;
  return reference::distance(to_point(cast<double>(mesh.normals[v])), unit);
}

TEST_P(ExtractorFieldReference, NormalsAreTheFieldsGradient) {
  const SphereSet spheres = cluster(40, 32);
  const ExtractOptions options = at_spacing(0.4);
  const ExtractResult result = extract(spheres, options);
  const Oracle oracle(spheres, options.field, result.grid);
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const Point p = to_point(result.mesh.positions[v]);
    Point expected;
    if (kind() == FieldKind::vdw) {
      expected = p - oracle.balls()[result.mesh.vertex_spheres.atoms[v]].center;
    } else {
      expected = -1.0 * oracle.gradient(p);
      if (reference::length(expected) < 1e-2) continue;  // a saddle has no direction
    }
    ASSERT_LE(normal_error(result.mesh, v, expected), kNormalTolerance) << "vertex " << v;
  }
}

// A blended vertex belongs to the atom that contributes most to the field there.
TEST_P(ExtractorFieldReference, ABlendedVertexNamesItsLargestContribution) {
  if (kind() == FieldKind::vdw) GTEST_SKIP() << "has its own test";
  const SphereSet spheres = cluster(40, 33);
  const ExtractOptions options = at_spacing(0.4);
  const ExtractResult result = extract(spheres, options);
  const auto balls = to_balls(spheres);
  const auto field = to_oracle(options.field, result.grid);
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const VertexSpheres on = result.mesh.vertex_spheres[v];
    ASSERT_LT(on[0], spheres.size());
    EXPECT_EQ(on[1], kNoSphere);
    EXPECT_EQ(on[2], kNoSphere);
    const Point p = to_point(result.mesh.positions[v]);
    double most = 0;
    for (const Ball& b : balls) most = worst(most, reference::contribution(field, b, p));
    // Double against double: some roundings of a number near 1.
    ASSERT_NEAR(reference::contribution(field, balls[on[0]], p), most, 1e-12) << "vertex " << v;
  }
}

// ---- other parameters than the default ----

struct Variant {
  const char* name;
  FieldOptions field;
};

// Blobbinesses and isovalues about the default's, and the thesis's presets.
std::vector<Variant> variants() {
  const FieldKind blinn = FieldKind::blinn, soft = FieldKind::soft_object,
                  inverse = FieldKind::inverse_squared;
  const FieldPreset aware = FieldPreset::radius_aware, thesis = FieldPreset::thesis;
  return {{"blobbiness 0.7", {blinn, aware, {}, 0.7}},
          {"blobbiness 5", {blinn, aware, {}, 5.0}},
          {"blobbiness 3 at 0.6", {blinn, aware, 0.6, 3.0}},
          {"soft at 0.5", {soft, aware, 0.5, {}}},
          {"thesis blinn", {blinn, thesis, {}, {}}},
          {"thesis soft", {soft, thesis, {}, {}}},
          {"thesis inverse squared", {inverse, thesis, {}, {}}},
          {"thesis vdw", {inverse, FieldPreset::thesis_vdw, {}, {}}}};
}

// The mesh of a variant beside its oracle.
struct Compared {
  SphereSet spheres;
  ExtractResult result;
  Oracle oracle;
  reference::FieldOracle field;

  Compared(const Extractor& extractor, const Variant& variant, unsigned seed)
      : spheres(cluster(40, seed)),
        result(extractor.extract(spheres, options_of(variant))),
        oracle(spheres, variant.field, result.grid),
        field(to_oracle(variant.field, result.grid)) {}

  static ExtractOptions options_of(const Variant& variant) {
    ExtractOptions options;
    options.field = variant.field;
    options.grid = preset_grid(variant.field.preset, {}, {});
    return options;
  }

  // False where the sub-grid of an atom ends between the vertex and its inside node: the field that
  // counts there is that of the node.
  bool has_one_field(std::size_t v) const {
    const Vec3d& position = result.mesh.positions[v];
    const auto edge = edge_of(result.grid, position);
    if (!edge) return false;
    const reference::DenseGrid grid = to_dense(result.grid);
    reference::Node other = edge->node;
    ++other[static_cast<std::size_t>(edge->axis)];
    for (const Ball& ball : oracle.balls()) {
      const bool here = reference::contribution(field, ball, to_point(position)) > 0;
      for (const reference::Node& node : {edge->node, other})
        if ((reference::contribution(field, ball, grid.position(node)) > 0) != here) return false;
    }
    return true;
  }
};

// float32 values of e^B and more at an atom leave fewer digits of sums about 1.
TEST_P(ExtractorReference, VariantsAreThoseOfDenseMarchingCubes) {
  for (const Variant& variant : variants()) {
    std::size_t compared = 0;
    for (unsigned seed = 1; seed <= 3 && compared == 0; ++seed) {
      const Compared c(*make_extractor(GetParam()), variant, seed);
      std::size_t undecided = 0;
      const auto dense = dense_mesh(c.oracle, c.result.grid, variant.field.kind, &undecided);
      if (undecided > 0) continue;
      ++compared;
      EXPECT_EQ(edges_of(c.result), edges_of(dense)) << variant.name << ", seed " << seed;
    }
    EXPECT_EQ(compared, 1u) << variant.name << ": too many nodes at the isovalue";
  }
}

TEST_P(ExtractorReference, VariantsHaveTheNormalsAndLabelsOfTheirField) {
  for (const Variant& variant : variants()) {
    const Compared c(*make_extractor(GetParam()), variant, 34);
    const IndexedMesh& mesh = c.result.mesh;
    std::size_t looked_at = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      if (!c.has_one_field(v)) continue;
      const Point p = to_point(mesh.positions[v]);
      const Point outward = -1.0 * c.oracle.gradient(p);
      if (reference::length(outward) < 0.1) continue;  // a saddle has no direction
      ++looked_at;
      ASSERT_LE(normal_error(mesh, v, outward), 4 * kNormalTolerance)
          << variant.name << ", vertex " << v;
      double most = 0;
      for (const Ball& b : c.oracle.balls())
        most = worst(most, reference::contribution(c.field, b, p));
      const Ball& named = c.oracle.balls().at(mesh.vertex_spheres.atoms[v]);
      // The strongest is found in float32: of nearly equal ones either may win.
      ASSERT_GE(reference::contribution(c.field, named, p), (1 - 1e-5) * most)
          << variant.name << ", vertex " << v;
    }
    EXPECT_GT(looked_at, mesh.vertex_count() / 10) << variant.name;
  }
}

// Cells of the layer of virtual nodes about the grid that have a node inside, by the oracle.
std::uint64_t clipped_cells(const reference::DenseGrid& grid, const Oracle& oracle) {
  std::uint64_t clipped = 0;
  const auto inside = [&](const reference::Node& n) {
    return grid.contains(n) && oracle.inside(grid.position(n));
  };
  for (std::int64_t z = -1; z <= grid.cells[2]; ++z) {
    for (std::int64_t y = -1; y <= grid.cells[1]; ++y) {
      for (std::int64_t x = -1; x <= grid.cells[0]; ++x) {
        int real = 0, in = 0;
        for (int corner = 0; corner < 8; ++corner) {
          const reference::Node n{x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)};
          real += grid.contains(n) ? 1 : 0;
          in += inside(n) ? 1 : 0;
        }
        clipped += real < 8 && in > 0 ? 1 : 0;
      }
    }
  }
  return clipped;
}

TEST_P(ExtractorFieldReference, ClippedCellsAreCountedOneByOne) {
  for (const double padding : {0.0, 0.3, 1.0}) {
    ExtractOptions options = at_spacing(0.5);
    options.grid.box = GridBox::centers;
    options.grid.padding = padding;
    const SphereSet spheres = cluster(25, 35);
    const ExtractResult result = extract(spheres, options);
    const Oracle oracle(spheres, options.field, result.grid);
    std::size_t undecided = 0;
    (void)dense_mesh(oracle, result.grid, kind(), &undecided);
    ASSERT_EQ(undecided, 0u) << "choose another seed";
    EXPECT_GT(result.stats.grid_clipped, 0u);
    EXPECT_EQ(result.stats.grid_clipped, clipped_cells(to_dense(result.grid), oracle)) << padding;
  }
}

// x² + y² + z² = 25 has the solutions (±5, 0, 0), which have five neighbours outside each, and
// (±3, ±4, 0), which have four, in all orders: 6 · 5 + 24 · 4 edges leave the ball where they
// begin. Binary fractions keep all of it exact.
TEST_P(ExtractorReference, ClampedVerticesAreCountedOneByOne) {
  for (const double h : {0.25, 0.5}) {
    ExtractOptions options;
    options.grid.spacing = h;
    const ExtractResult result = extract(one_sphere(5 * h), options);
    EXPECT_EQ(result.stats.clamped_vertices, 126u);
    // Half a spacing further no node is on the sphere.
    options.grid.padding = 3.25 * h;
    EXPECT_EQ(extract(one_sphere(5 * h), options).stats.clamped_vertices, 0u);
  }
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorReference);
VDWMESH_INSTANTIATE_FIELDS(ExtractorFieldReference);

}  // namespace
}  // namespace vdwmesh::testing
