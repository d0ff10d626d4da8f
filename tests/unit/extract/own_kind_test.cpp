// A kind of field that the library does not have, made by the recipe of docs/library.md: everything
// that extraction asks of a kind is in its type, so a test can add one.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "extract/blended/blended_brick.hpp"
#include "extract/blended/block_bounds.hpp"
#include "extract/blended/field_sample.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/field_kinds.hpp"
#include "extract/field_list.hpp"
#include "reference/mesh_checks.hpp"
#include "support/mesh_bricks.hpp"
#include "support/plain_extractor.hpp"
#include "support/reference_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// f = A (1 - q)^2 for q = s d^2 < 1, else 0: the metaballs of Murakami and Ichihara (1987).
struct Metaball {
  template <class T>
  VDWMESH_HD static bool reaches(const ShapeParameters<T>&, T q) {
    return q < T(1);
  }
  template <class T>
  VDWMESH_HD static T value(const ShapeParameters<T>& p, T d2, T s) {
    const T rest = std::fma(-d2, s, T(1));
    return rest > T(0) ? p.amplitude * (rest * rest) : T(0);
  }
  template <class T>
  VDWMESH_HD static ValueAndSlope<T> value_and_slope(const ShapeParameters<T>& p, T d2, T s) {
    const T rest = std::fma(-d2, s, T(1));
    if (!(rest > T(0))) return {T(0), T(0)};
    return {p.amplitude * (rest * rest), T(-2) * s * p.amplitude * rest};
  }
  template <class T>
  VDWMESH_HD static bool is_convex_beyond(const ShapeParameters<T>&, T) {
    return true;
  }
  template <class T>
  VDWMESH_HD static T absolute_rounding(const ShapeParameters<T>& p) {
    return T(4e-6) * p.amplitude;
  }
  VDWMESH_HD static NodeShape node_shape(const FieldModel& m) {
    return {0, static_cast<float>(m.amplitude), 0, 0, 0};
  }
  VDWMESH_HD static AxisTerm axis_term(const NodeShape&, float scale, int, float offset) {
    return {offset * offset * scale, 1.0f};
  }
  VDWMESH_HD static RowTerm row_term(const NodeShape& p, const AxisTerm& y, const AxisTerm& z) {
    return {1.0f - (y.square + z.square), p.amplitude};
  }
  VDWMESH_HD static bool row_is_out_of_reach(const NodeShape&, const RowTerm& row) {
    return !(row.rest > 0);
  }
  VDWMESH_HD static float add_atom(const NodeShape&, const RowTerm& row, const AxisTerm& x, float,
                                   float sum) {
    const float rest = positive_part(row.rest - x.square);
    return std::fma(rest * rest, row.factor, sum);
  }
  static double largest_factor(const FieldModel&) { return 1; }
  static void set_radius_aware(const FieldOptions&, FieldModel& m) {
    m.radius_scale = 0.25;  // f ends at two radii,
    m.reach_radii = 2;
    m.amplitude = 16.0 / 9;  // and is 1 at one
  }
  static void set_thesis(const FieldOptions&, FieldModel&) {}
};
static_assert(BlendedKind<Metaball>);

struct Scene {
  SphereSet spheres;
  FieldModel model;
  CellList list;
};

Scene make_scene(std::vector<Sphere> balls, double spacing) {
  SphereSet spheres(std::move(balls));
  GridOptions grid;
  grid.spacing = spacing;
  FieldModel model{};
  model.kind = FieldKind::blinn;  // of none of the library's; anything but vdw
  model.isovalue = 1;
  model.grid = make_grid(spheres, grid);
  Metaball::set_radius_aware({}, model);
  CellList list = make_field_list(spheres, model);
  return {std::move(spheres), model, std::move(list)};
}

ExtractResult extract(const Scene& scene) {
  using Surface = BlendedBrick<Metaball>;
  const BrickLoops loops{[&](std::span<const std::uint64_t> keys, ActiveBrick* out) {
                           Surface surface(scene.list.view(), scene.model);
                           return count_bricks(surface, scene.model.grid, keys, out);
                         },
                         [&](const Emission& e, std::size_t begin, std::size_t end) {
                           Surface surface(scene.list.view(), scene.model);
                           return emit_bricks(e, begin, end, surface);
                         }};
  return testing::mesh_bricks(scene.model.grid, [&] { return all_bricks(scene.model.grid); }, loops,
                              LabelWidth::one, {});
}

std::vector<Sphere> cluster(unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-4, 4), radius(0.8, 2);
  std::vector<Sphere> balls;
  for (int i = 0; i < 30; ++i) {
    const double x = place(random), y = place(random), z = place(random);
    balls.push_back({{x, y, z}, radius(random)});
  }
  return balls;
}

// An isolated atom's isosurface is its sphere: linear interpolation along edges of length h errs by
// h² / 8 times the second derivative of f over its slope, which is below 5 / R here.
TEST(OwnKind, OneAtomIsItsSphere) {
  constexpr double kRadius = 1.5, kSpacing = 0.1;
  const Scene scene = make_scene({{{0.1, 0.2, 0.3}, kRadius}}, kSpacing);
  const ExtractResult result = extract(scene);
  EXPECT_GT(result.mesh.triangle_count(), 1000u);
  for (const Vec3d& p : result.mesh.positions) {
    ASSERT_NEAR(norm(p - scene.spheres[0].center), kRadius, kSpacing * kSpacing / 8 * 5 / kRadius);
  }
}

// Along an edge of length h linear interpolation errs by at most h²/8 of the largest second
// derivative: of an atom that reaches the edge, f'' lies between -4 A s and 8 A s.
double interpolation_error(const Scene& scene, const Vec3d& p) {
  const double h = scene.model.grid.spacing;
  double curvature = 0;
  for (const Sphere& atom : scene.spheres.spheres()) {
    const double reach = scene.model.reach_radii * atom.radius;
    if (norm(p - atom.center) > reach + h) continue;
    curvature += 8 * scene.model.amplitude * inverse_square_scale(scene.model, atom.radius);
  }
  return h * h / 8 * curvature;
}

TEST(OwnKind, MeshesAreClosedAndTheirVerticesOnTheIsosurface) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Scene scene = make_scene(cluster(seed), 0.3);
    const ExtractResult result = extract(scene);
    const reference::MeshFacts facts = reference::inspect(to_reference(result.mesh));
    EXPECT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
    for (const Vec3d& p : result.mesh.positions) {
      const FieldSample f = sample_field<Metaball>(scene.list.view(), scene.model, p);
      constexpr double kFloat32 = 1e-5;
      ASSERT_LE(std::abs(f.value - 1), interpolation_error(scene, p) + kFloat32) << seed;
    }
  }
}

TEST(OwnKind, BoundsLoseNoBrick) {
  for (const unsigned seed : {4u, 5u}) {
    const Scene scene = make_scene(cluster(seed), 0.25);
    BlendedBrick<Metaball> surface(scene.list.view(), scene.model);
    int left_out = 0;
    for (const std::uint64_t key : all_bricks(scene.model.grid)) {
      const LatticeBlock block = lattice_block(brick_of_key(key), 0);
      const BlockBox box = block_box(scene.model.grid, block);
      if (box.empty || field_may_cross<Metaball>(scene.list.view(), scene.model, block, box))
        continue;
      ++left_out;
      BrickSigns signs;
      surface.visit(brick_of_key(key));
      surface.signs(signs);
      EXPECT_TRUE(is_uniform(signs)) << key;
    }
    EXPECT_GT(left_out, 10);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
