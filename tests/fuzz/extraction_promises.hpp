// What marching cubes promise of places, found by the reference code: which grid edges hold a
// vertex, and for the union of balls that the vertices lie on its boundary. The area is not
// compared with the exact one: a coarse grid bridges narrow gaps, and the mesh of a row of small
// balls is a rod whose area can be larger than theirs.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "extract/extractor.hpp"
#include "fuzz/mesh_promises.hpp"
#include "reference/dense_mc.hpp"
#include "reference/field_oracle.hpp"
#include "support/reference_mesh.hpp"

namespace vdwmesh::fuzz {

using testing::to_point;

// Relative to the largest coordinate or radius: some thousand roundings of a double.
inline constexpr double kPlaceRounding = 1e-12;
// The extractor keeps vertices this share of an edge away from its ends.
inline constexpr double kClampParameter = 1.0 / (1 << 20);
// Of the isovalue: sums of 40 terms, and their exponentials, in single precision.
inline constexpr double kValueRounding = 1e-4;

inline std::vector<reference::Ball> to_balls(const SphereSet& spheres) {
  std::vector<reference::Ball> balls;
  for (const Sphere& s : spheres.spheres()) balls.push_back({to_point(s.center), s.radius});
  return balls;
}

inline double largest_number(const SphereSet& spheres) {
  double largest = 0;
  for (const Sphere& s : spheres.spheres()) {
    for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(s.center[axis]));
    largest = std::max(largest, s.radius);
  }
  return largest;
}

// Every vertex lies on the sphere that it names and inside no ball.
inline void check_union_vertices(const SphereSet& spheres, const ExtractResult& result) {
  const auto balls = to_balls(spheres);
  const double clamped =
      result.stats.clamped_vertices > 0 ? kClampParameter * result.grid.spacing : 0;
  const double tolerance =  // Å
      clamped + kPlaceRounding * (largest_number(spheres) + result.grid.spacing);
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const reference::Point p = to_point(result.mesh.positions[v]);
    const reference::Ball& named = balls[result.mesh.vertex_spheres[v][0]];
    const double off = reference::distance(p, named.center) - named.radius;
    require(std::abs(off) <= tolerance, "a vertex lies on the sphere that it names");
    const double depth = -reference::sample_union(balls, p).signed_distance;
    require(depth <= tolerance, "no vertex lies inside a ball");
  }
}

// How far inside a node is, and whether roundings could turn its sign.
struct NodeDepth {
  double depth;
  bool undecided;
};

class NodeOracle {
 public:
  NodeOracle(const SphereSet& spheres, const FieldOptions& field, const GridSpec& grid)
      : balls_(to_balls(spheres)),
        is_union_(field.kind == FieldKind::vdw),
        margin_(kPlaceRounding * (largest_number(spheres) + grid.spacing)) {
    field_.lattice = {to_point(grid.origin), grid.spacing};
    field_.function = field.kind == FieldKind::blinn         ? reference::Function::blinn
                      : field.kind == FieldKind::soft_object ? reference::Function::soft_object
                                                             : reference::Function::inverse_squared;
    field_.preset = field.preset == FieldPreset::radius_aware ? reference::Preset::radius_aware
                    : field.preset == FieldPreset::thesis     ? reference::Preset::thesis
                                                              : reference::Preset::thesis_vdw;
    if (is_union_) return;
    isovalue_ = field.isovalue.value_or(reference::default_isovalue(field_));
    margin_ = kValueRounding * isovalue_;
  }
  NodeDepth at(const reference::Point& p) const {
    const double depth = is_union_ ? -reference::sample_union(balls_, p).signed_distance
                                   : reference::sample_field(field_, balls_, p).value - isovalue_;
    return {depth, !(std::abs(depth) > margin_)};
  }

 private:
  std::vector<reference::Ball> balls_;
  reference::FieldOracle field_;
  bool is_union_;
  double isovalue_ = 0, margin_;
};

// The reference code defines the preset thesis_vdw for the field that it was fitted with alone.
inline bool has_oracle(const FieldOptions& field) {
  return field.preset != FieldPreset::thesis_vdw || field.kind == FieldKind::inverse_squared;
}

// The mesh has the vertices, triangles and shells of marching cubes over every node of the grid.
// Says nothing where roundings decide the sign of a node.
inline void check_against_dense(const SphereSet& spheres, const FieldOptions& field,
                                const ExtractResult& result, const reference::MeshFacts& facts) {
  const NodeOracle oracle(spheres, field, result.grid);
  const Vec3i& cells = result.grid.cells;
  const reference::DenseGrid grid{
      to_point(result.grid.origin), result.grid.spacing, {cells.x, cells.y, cells.z}};
  bool decided = true;
  const auto inside = [&](const reference::Node& node) {
    const NodeDepth found = oracle.at(grid.position(node));
    decided = decided && !found.undecided;
    return found.depth >= 0;
  };
  const auto middle = [](const reference::Point& a, const reference::Point& b) {
    return 0.5 * (a + b);
  };
  const auto dense = reference::dense_marching_cubes(grid, inside, middle);
  if (!decided) return;
  const reference::MeshFacts expected = reference::inspect(dense.mesh);
  require(facts.vertices == expected.vertices, "vertices as of all nodes");
  require(facts.triangles == expected.triangles, "triangles as of all nodes");
  require(facts.positive_shells == expected.positive_shells, "components as of all nodes");
  require(facts.negative_shells == expected.negative_shells, "voids as of all nodes");
}

}  // namespace vdwmesh::fuzz
