// A bound on the angles of triangles: patches with corners of known angles, sets like proteins and
// sets unlike them. Which triangles are excused is found from the spheres alone, by
// tests/support/sharp_corners.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "contract/exact_mesher_contract.hpp"
#include "core/errors.hpp"
#include "support/dice.hpp"
#include "support/sharp_corners.hpp"
#include "support/sphere_recipes.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherAngles : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherAngles);

ExactMesh bounded_mesh(const SphereSet& spheres, double min_angle, double edge_length) {
  ExactMeshOptions options;
  options.edge_length = edge_length;
  options.min_angle = min_angle;
  return mesh_with(spheres, options);
}

// A unit ball between two others, whose circles on it lie at the distance h from its centre and
// cross in two points. What they leave of it is a strip that ends in two corners of this angle. The
// tangents of the circles at a corner p are n × p for the directions n of the two others, and their
// cosine is (n·m - h²) / (1 - h²); the strip has what is left to half a turn.
SphereSet lens(double degrees) {
  const double h = 0.2, cosine = std::cos(degrees * std::numbers::pi / 180);
  // n·m = -cos 2a for n, m = (±cos a, sin a, 0).
  const double a = std::acos((1 - h * h) * cosine - h * h) / 2;
  const Vec3d right{2 * h * std::cos(a), 2 * h * std::sin(a), 0}, left{-right.x, right.y, 0};
  return SphereSet({{{0, 0, 0}, 1}, {right, 1}, {left, 1}});
}

TEST_P(ExactMesherAngles, CornersOfKnownAngles) {
  for (const double degrees : {1.0, 5.0, 12.0, 25.0, 45.0, 59.0}) {
    SCOPED_TRACE(degrees);
    const SphereSet spheres = lens(degrees);
    const ExactMesh made = bounded_mesh(spheres, 20, 0.2);
    expect_union_mesh(spheres, made.mesh, exact_union(spheres), {});
    const BoundedAngles found = bounded_angles(spheres, made.mesh, 20);
    // The strip's two; the two other balls are far from covered.
    EXPECT_EQ(found.sharp_corners, 2u);
    EXPECT_GE(found.smallest, 20) << found.text();
    EXPECT_EQ(made.stats.below_min_angle, 0u);
    EXPECT_EQ(made.stats.below_min_angle_at_corners, found.below_excused);
    // A corner of less than the bound has a triangle below it.
    EXPECT_GE(found.below_excused, degrees < 20 ? 2u : 0u);
  }
}

// Half of the sets without a bound have such triangles, or the test would prove nothing.
TEST_P(ExactMesherAngles, SetsLikeProteins) {
  int with_small = 0;
  for (unsigned seed = 0; seed < 24; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(700 + seed);
    std::vector<Sphere> balls;
    const double half = std::cbrt(9.0 * 40) / 2;  // as dense as a protein
    for (int i = 0; i < 40; ++i) {
      balls.push_back({{dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)},
                       dice.real(1.2, 1.9)});
    }
    const SphereSet spheres(balls);
    const ExactMesh plain = bounded_mesh(spheres, 0, 0.35), made = bounded_mesh(spheres, 20, 0.35);
    expect_union_mesh(spheres, made.mesh, exact_union(spheres), {});
    with_small += bounded_angles(spheres, plain.mesh, 20).below > 0;
    const BoundedAngles found = bounded_angles(spheres, made.mesh, 20);
    EXPECT_EQ(found.below, 0u) << found.text();
    EXPECT_EQ(made.stats.below_min_angle, 0u);
    EXPECT_EQ(made.stats.below_min_angle_at_corners, found.below_excused);
    EXPECT_LE(10 * made.mesh.triangle_count(), 14 * plain.mesh.triangle_count());
    EXPECT_EQ(plain.stats.below_min_angle + plain.stats.below_min_angle_at_corners, 0u);
  }
  EXPECT_GE(with_small, 12);
}

// Nearly degenerate ones too: the mesh stays sound and keeps its announced topology, and the mesher
// says how many triangles are below the bound, to those that rounding puts on either side of it.
TEST_P(ExactMesherAngles, SetsOfAllKinds) {
  for (unsigned seed = 0; seed < 64; ++seed) {
    const SeededSet set = seeded_set(seed);
    const SphereRecipe& recipe = sphere_recipes()[set.recipe];
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::string(recipe.name));
    try {
      const ExactMesh made = bounded_mesh(set.spheres, 20, set.edge_length);
      expect_union_mesh(set.spheres, made.mesh, exact_union(set.spheres),
                        demands_of_set(set, made.stats));
      if (recipe.position == Position::general) {
        EXPECT_EQ(bounded_angles(set.spheres, made.mesh, 20).below, made.stats.below_min_angle);
      }
    } catch (const LimitExceeded&) {
      EXPECT_EQ(recipe.name, "pencils");
    }
  }
}

TEST_P(ExactMesherAngles, AnyNumberOfThreads) {
  const SphereSet spheres = seeded_set(3).spheres;
  const IndexedMeshHash all = hash(bounded_mesh(spheres, 25, 0.3).mesh);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(hash(bounded_mesh(spheres, 25, 0.3).mesh), all);
}

TEST_P(ExactMesherAngles, TheCpuMakesTheMeshAndSaysSo) {
  const ExactMesh made = bounded_mesh(lens(5), 20, 0.3);
  EXPECT_EQ(made.fallback.empty(), GetParam() == Backend::cpu) << made.fallback;
  EXPECT_EQ(made.stats.device_patches, 0u);
}

TEST_P(ExactMesherAngles, OutOfRange) {
  for (const double wrong : {-1.0, 25.1, 90.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(bounded_mesh(lens(5), wrong, 0.3), InvalidInput) << wrong;
  }
}

}  // namespace
}  // namespace vdwmesh::testing
