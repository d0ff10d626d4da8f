// Every vertex lies on the surface it was projected to: checked against the slow oracles.
#include <algorithm>
#include <cmath>
#include <optional>

#include "contract/refiner_contract.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerProjection : public RefinerContract {};
class RefinerFieldProjection : public RefinerFieldContract {};

// The oracle sums in another order: 1e-12 Å is a thousand times the rounding of its distances.
constexpr double kOnSurface = kProjectionTolerance + 1e-12;  // Å

TEST_P(RefinerProjection, VerticesLieOnTheBoundaryOfTheUnion) {
  const SphereSet spheres = cluster(60, 7);
  const auto balls = to_balls(spheres);
  const RefineResult result =
      refine(spheres, marching_cubes(spheres, 0.5).mesh, refine_options(2, Projection::vdw));
  std::uint64_t off = 0;
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const reference::Point p = to_point(result.mesh.positions[v]);
    if (!(std::abs(reference::sample_union(balls, p).signed_distance) <= kOnSurface)) {
      ++off;
      continue;
    }
    ASSERT_NE(result.mesh.vertex_spheres[v][0], kNoSphere);
    for (const SphereId id : result.mesh.vertex_spheres[v]) {
      if (id == kNoSphere) continue;
      const double d = reference::distance(p, balls[id].center) - balls[id].radius;
      EXPECT_LE(std::abs(d), kOnSurface) << "vertex " << v << " is not on its sphere " << id;
    }
  }
  EXPECT_LE(off, left_out(result));
  for (const ProjectionStats& s : result.levels) {
    EXPECT_LE(s.residual_max, kProjectionTolerance);
    EXPECT_LE(s.iterations_max, kMaxProjectionSteps);
  }
  EXPECT_LT(static_cast<double>(left_out(result)),
            0.01 * static_cast<double>(result.mesh.vertex_count()));
}

TEST_P(RefinerProjection, EveryVertexIsCountedOnce) {
  const SphereSet spheres = cluster(60, 8);
  const IndexedMesh mesh = marching_cubes(spheres, 0.6).mesh;
  const RefineResult result = refine(spheres, mesh, refine_options(3, Projection::vdw));
  ASSERT_EQ(result.levels.size(), 4u);
  std::uint64_t handled = mesh.vertex_count(), triangles = mesh.triangle_count();
  for (const ProjectionStats& s : result.levels) {
    EXPECT_EQ(s.projected + s.unconverged + s.out_of_reach + s.undone, handled);
    handled = triangles * 3 / 2;
    triangles *= 4;
  }
}

TEST_P(RefinerProjection, WhatIsOnTheBoundaryStaysBitForBit) {
  const SphereSet spheres = cluster(80, 9);
  const auto balls = to_balls(spheres);
  const IndexedMesh mesh = marching_cubes(spheres, 0.4).mesh;
  const RefineResult result = refine(spheres, mesh, refine_options(1, Projection::vdw));
  std::size_t stayed = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const double d = reference::sample_union(balls, to_point(mesh.positions[v])).signed_distance;
    if (!(std::abs(d) <= 0.99 * kProjectionTolerance)) continue;
    ++stayed;
    ASSERT_EQ(result.mesh.positions[v], mesh.positions[v]);
    ASSERT_EQ(result.mesh.vertex_spheres[v], mesh.vertex_spheres[v]);
  }
  EXPECT_GT(stayed, mesh.vertex_count() / 2);
}

// A vertex on the boundary keeps its label only where it lies on the spheres that this names: a
// third of these labels name another sphere, and a third none.
TEST_P(RefinerProjection, AWrongLabelIsReplacedWhereNothingMoves) {
  const SphereSet spheres = cluster(40, 14);
  const auto balls = to_balls(spheres);
  IndexedMesh mesh = marching_cubes(spheres, 0.5).mesh;
  const auto count = static_cast<SphereId>(spheres.size());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    SphereId& atom = mesh.vertex_spheres.atoms[v];
    if (v % 3 == 0) atom = (atom + 1) % count;
    if (v % 3 == 1) atom = kNoSphere;
  }
  const IndexedMesh result = refine(spheres, mesh, refine_options(0, Projection::vdw)).mesh;
  std::size_t on = 0;
  for (std::size_t v = 0; v < result.vertex_count(); ++v) {
    const reference::Point p = to_point(result.positions[v]);
    if (!(std::abs(reference::sample_union(balls, p).signed_distance) <= kOnSurface)) continue;
    ++on;
    ASSERT_NE(result.vertex_spheres[v][0], kNoSphere) << "vertex " << v;
    for (const SphereId id : result.vertex_spheres[v]) {
      if (id == kNoSphere) continue;
      const double d = reference::distance(p, balls[id].center) - balls[id].radius;
      ASSERT_LE(std::abs(d), kOnSurface) << "vertex " << v;
    }
  }
  EXPECT_GT(on, result.vertex_count() / 2);
}

// A mesh of another surface, at most a few tenths of an ångström away, is pulled onto the union.
TEST_P(RefinerProjection, ABlendedMeshIsPulledOntoTheUnion) {
  const SphereSet spheres = cluster(40, 10);
  const auto balls = to_balls(spheres);
  const IndexedMesh mesh = marching_cubes(spheres, 0.4, FieldKind::soft_object).mesh;
  const RefineResult result = refine(spheres, mesh, refine_options(0, Projection::vdw));
  std::uint64_t on = 0;
  for (const Vec3d& p : result.mesh.positions) {
    on += std::abs(reference::sample_union(balls, to_point(p)).signed_distance) <= kOnSurface;
  }
  EXPECT_GE(on, result.levels[0].projected);
  EXPECT_GT(2 * on, mesh.vertex_count());
}

// A vertex that moves takes the label of the surface that it went to, whatever the given one says:
// here that is the first atom's, the second being far away.
TEST_P(RefinerFieldProjection, AMovedVertexLosesItsWrongLabel) {
  const SphereSet spheres = spheres_of({{{0, 0, 0}, 1.5}, {{50, 0, 0}, 1.5}});
  IndexedMesh mesh = octahedron();
  mesh.vertex_spheres.assign(mesh.vertex_count(), on_sphere(1));
  const GridSpec grid{{-3, -3, -3}, 0.5, {12, 12, 12}};
  const RefineResult result = refine(spheres, mesh, field_options(0, kind(), grid));
  ASSERT_EQ(result.levels[0].projected, mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    ASSERT_NE(result.mesh.positions[v], mesh.positions[v]);
    EXPECT_EQ(result.mesh.vertex_spheres[v], on_sphere(0)) << "vertex " << v;
  }
}

struct Bisected {
  double residual;               // |F - T| / |grad F|, Å
  std::optional<double> offset;  // from the vertex to F = T along its normal, Å
};

constexpr double kProbe = 1e-3;  // Å, how far along the normal the oracle brackets the surface

Bisected bisected(const reference::FieldOracle& oracle, const std::vector<reference::Ball>& balls,
                  const reference::Point& p, const Vec3f& normal) {
  const double isovalue = reference::default_isovalue(oracle);
  const reference::FieldSample here = reference::sample_field(oracle, balls, p);
  Bisected result{std::abs(here.value - isovalue) / reference::length(here.gradient), {}};
  const reference::Point n = to_point(cast<double>(normal));
  const auto inside = [&](const reference::Point& q) {
    return reference::sample_field(oracle, balls, q).value >= isovalue;
  };
  result.offset = reference::bisect(inside, p - kProbe * n, n, 2 * kProbe);
  if (result.offset) *result.offset -= kProbe;
  return result;
}

// A float normal is off by 1e-7 at most, which moves the crossing by less than 1e-16 Å.
TEST_P(RefinerFieldProjection, VerticesLieOnTheIsosurfaceByBisection) {
  const SphereSet spheres = cluster(25, 11);
  const auto balls = to_balls(spheres);
  const ExtractResult extracted = marching_cubes(spheres, 0.5, kind());
  const RefineOptions options = field_options(1, kind(), extracted.grid);
  const reference::FieldOracle oracle = to_oracle(options.field, extracted.grid);
  const RefineResult result = refine(spheres, extracted.mesh, options);
  std::uint64_t off = 0;
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const Bisected b =
        bisected(oracle, balls, to_point(result.mesh.positions[v]), result.mesh.normals[v]);
    const bool on = b.residual <= kOnSurface && b.offset && std::abs(*b.offset) <= kOnSurface;
    off += !on;
  }
  EXPECT_LE(off, left_out(result));
  EXPECT_LT(static_cast<double>(left_out(result)),
            0.01 * static_cast<double>(result.mesh.vertex_count()));
}

TEST_P(RefinerFieldProjection, NormalsPointDownTheGradient) {
  const SphereSet spheres = cluster(25, 12);
  const auto balls = to_balls(spheres);
  const ExtractResult extracted = marching_cubes(spheres, 0.5, kind());
  const RefineOptions options = field_options(0, kind(), extracted.grid);
  const reference::FieldOracle oracle = to_oracle(options.field, extracted.grid);
  const RefineResult result = refine(spheres, extracted.mesh, options);
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const reference::Point g =
        reference::sample_field(oracle, balls, to_point(result.mesh.positions[v])).gradient;
    const reference::Point n = to_point(cast<double>(result.mesh.normals[v]));
    // Floats: 2^-24 per component.
    ASSERT_LE(reference::length(n + (1 / reference::length(g)) * g), 2e-7);
  }
}

// Of the vertices, at most, that may be left out. Inverse squares never vanish, so they are cut off
// while they are still strong, beside many vertices; the others have all but gone by then.
double most_left_out(FieldKind kind) { return kind == FieldKind::inverse_squared ? 1.0 / 3 : 0.01; }

// The thesis's sub-grids cut the field off at their faces, where there is no surface to converge
// to: whoever ends there is counted, everyone else is on the isosurface.
TEST_P(RefinerFieldProjection, ThesisPresetIsOnTheIsosurfaceOrCounted) {
  const FieldPreset preset =
      kind() == FieldKind::inverse_squared ? FieldPreset::thesis_vdw : FieldPreset::thesis;
  const SphereSet spheres = cluster(25, 13);
  const auto balls = to_balls(spheres);
  ExtractOptions extract;
  extract.field = {kind(), preset, {}, {}};
  extract.grid = preset_grid(preset, {}, {});
  const ExtractResult extracted = make_cpu_extractor()->extract(spheres, extract);
  RefineOptions options = field_options(1, kind(), extracted.grid);
  options.field = extract.field;
  const reference::FieldOracle oracle = to_oracle(options.field, extracted.grid);
  const RefineResult result = refine(spheres, extracted.mesh, options);
  std::uint64_t off = 0;
  for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
    const Bisected b =
        bisected(oracle, balls, to_point(result.mesh.positions[v]), result.mesh.normals[v]);
    off += !(b.residual <= kOnSurface);
  }
  EXPECT_LE(off, left_out(result));
  EXPECT_LT(static_cast<double>(left_out(result)),
            most_left_out(kind()) * static_cast<double>(result.mesh.vertex_count()));
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerProjection);
VDWMESH_INSTANTIATE_BLENDED_FIELDS(RefinerFieldProjection);

}  // namespace
}  // namespace vdwmesh::testing
