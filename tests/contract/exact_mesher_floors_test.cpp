// The floors of angles: no angle of a mesh is below 5°, or below half of the exact angle at a
// corner of a patch where that is less. Found from the spheres alone, by
// tests/support/crease_survey: in molecules in which one patch or another would have such an angle,
// over arcs of any shortness, in corners of any sharpness, and in sets of all kinds.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contract/exact_mesher_contract.hpp"
#include "core/errors.hpp"
#include "support/sphere_recipes.hpp"
#include "unit/arrangement/union_reference_sets.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherFloors : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherFloors);

// Returns what it has found.
AngleCensus expect_floors(const SphereSet& spheres, double edge_length) {
  const IndexedMesh mesh = expect_union_meshes(spheres, edge_length, 1);
  const AngleCensus census = angle_census(spheres, mesh);
  EXPECT_EQ(census.unexplained, 0u) << census.text();
  return census;
}

// Without anything for the floors these have 1 to 6 angles below theirs: the first two between
// arcs that meet at 1° or less and across narrow places, the third over an arc of 2e-5 Å, the last
// one by what a second smoothing mends.
TEST_P(ExactMesherFloors, Molecules) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  struct Case {
    const char* set;
    double probe, edge_length;
  };
  for (const Case& c : {Case{"1EJG", 0, 0.35}, Case{"4PTI", 1.4, 0.5}, Case{"4PTI", 1.4, 0.35},
                        Case{"1HH0", 0, 0.35}, Case{"1L2Y", 0, 0.5}}) {
    SCOPED_TRACE(std::string(c.set) + ", edge length " + std::to_string(c.edge_length));
    expect_floors(SphereSet(reference_balls(c.set, c.probe)), c.edge_length);
  }
}

// Four spheres whose radii differ by little from those that pass through one point, on one side of
// it: two of them meet in an arc about as long as the difference.
SphereSet short_arc(double difference) {
  const Vec3d corner{0.3, 0.2, 0.1};
  const std::vector<Vec3d> centers{
      {1, 0.2, -1}, {-0.9, 0.8, -1.1}, {-0.7, -1, -0.9}, {0.6, -0.8, -1.2}};
  std::vector<Sphere> balls;
  for (const Vec3d& c : centers) balls.push_back({c, norm(c - corner)});
  balls[0].radius += difference;
  return SphereSet(std::move(balls));
}

TEST_P(ExactMesherFloors, ShortArcs) {
  for (const double difference : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 2e-7}) {
    for (const double edge_length : {0.5, 0.2}) {
      SCOPED_TRACE(std::to_string(edge_length) + ", " + std::to_string(std::log10(difference)));
      const SphereSet spheres = short_arc(difference);
      expect_floors(spheres, edge_length);
      EXPECT_EQ(mesh_at(spheres, edge_length).stats.points, 0u);
    }
  }
}

// A unit ball between two others, whose circles on it lie at the distances h and k from its centre
// and cross in two points, with a strip between them that ends in two corners of this angle; and a
// fourth ball that takes away one of the two, so that the pieces at the other differ in length. The
// cosine of the angle is -(n·m - h k) / (√(1 - h²) √(1 - k²)) for the directions n and m of the
// two.
SphereSet strip(double degrees, double h, double k) {
  const double cosine = std::cos(degrees * std::numbers::pi / 180);
  const double dots = -cosine * std::sqrt((1 - h * h) * (1 - k * k)) + h * k;
  // The radii of the others are 1, at twice the distance of their circles.
  const Vec3d n{1, 0, 0}, m{dots, std::sqrt(1 - dots * dots), 0};
  return SphereSet({{{0, 0, 0}, 1}, {2 * h * n, 1}, {2 * k * m, 1}, {{0.1, 0.35, -1.15}, 0.8}});
}

TEST_P(ExactMesherFloors, SharpCorners) {
  for (const double degrees : {20.0, 8.0, 3.0, 1.0, 0.3, 0.1, 0.01}) {
    for (const double k : {0.2, 0.3, 0.45}) {
      SCOPED_TRACE(std::to_string(degrees) + "°, " + std::to_string(k));
      const AngleCensus census = expect_floors(strip(degrees, 0.2, k), 0.3);
      EXPECT_LE(census.sharpest_corner, degrees * (1 + 1e-6));
    }
  }
}

// Sound, as announced, and never refused where it was not: nearly degenerate sets too.
TEST_P(ExactMesherFloors, SetsOfAllKinds) {
  std::uint64_t below = 0;
  for (unsigned seed = 0; seed < 96; ++seed) {
    const SeededSet set = seeded_set(seed);
    const SphereRecipe& recipe = sphere_recipes()[set.recipe];
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::string(recipe.name));
    try {
      const ExactMesh made = mesh_at(set.spheres, set.edge_length);
      expect_union_mesh(set.spheres, made.mesh, exact_union(set.spheres),
                        demands_of_set(set, made.stats));
      if (recipe.position == Position::general) {
        below += angle_census(set.spheres, made.mesh).unexplained;
      }
    } catch (const LimitExceeded&) {
      EXPECT_EQ(recipe.name, "pencils");
    }
  }
  EXPECT_EQ(below, 0u);
}

TEST_P(ExactMesherFloors, AnyNumberOfThreads) {
  const SphereSet spheres = short_arc(1e-5);
  const IndexedMeshHash all = hash(mesh_at(spheres, 0.3).mesh);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(hash(mesh_at(spheres, 0.3).mesh), all);
}

}  // namespace
}  // namespace vdwmesh::testing
