// The floors of angles: no angle of a mesh is below 5°, or below half of the exact angle at a
// corner of a patch where that is less. Found from the spheres alone, by
// tests/support/crease_survey: in molecules in which one patch or another would have such an angle,
// over arcs of any shortness, in corners of any sharpness, and in sets of all kinds.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <string>
#include <vector>

#include "contract/exact_mesher_contract.hpp"
#include "support/floor_sets.hpp"
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
  EXPECT_EQ(mesh_at(spheres, edge_length).stats.below_floor, 0u);
  return census;
}

// Without anything for the floors these have 1 to 5 angles below theirs: the first three between
// arcs that meet at 1° and across narrow places, the fourth over an arc of 2e-5 Å, the last one
// across narrow places.
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

// The strip's two arcs are of different length; and of different edge lengths, so that the pieces
// at their corners are, too.
TEST_P(ExactMesherFloors, SharpCorners) {
  for (const double degrees : {20.0, 8.0, 3.0, 1.0, 0.3, 0.1, 0.01}) {
    for (const double k : {0.2, 0.3, 0.45}) {
      for (const double beside : {0.3, 0.19}) {
        SCOPED_TRACE(std::to_string(degrees) + "°, " + std::to_string(k) + ", edges " +
                     std::to_string(beside));
        const SphereSet spheres = strip(degrees, 0.2, k);
        const std::vector<double> lengths{0.3, 0.3, beside, 0.3};
        const IndexedMesh mesh = mesh_with(spheres, {.edge_lengths = lengths}).mesh;
        expect_union_mesh(spheres, mesh, exact_union(spheres), {});
        const AngleCensus census = angle_census(spheres, mesh);
        EXPECT_EQ(census.unexplained, 0u) << census.text();
        EXPECT_LE(census.sharpest_corner, degrees * (1 + 1e-6));
      }
    }
  }
}

// What is left below the floors is counted: the mesher's number is that found from the spheres.
TEST_P(ExactMesherFloors, AnglesThatAreLeft) {
  const SphereSet spheres = near_pencil();
  for (const double edge_length : {0.5, 0.35}) {
    const ExactMesh made = mesh_at(spheres, edge_length);
    const AngleCensus census = angle_census(spheres, made.mesh);
    EXPECT_GT(census.unexplained, 0u);
    EXPECT_EQ(made.stats.below_floor, census.unexplained) << census.text();
  }
  EXPECT_FALSE(mesh_with(spheres, {.edge_length = 0.5, .min_angle = 10}).stats.below_floor);
}

TEST_P(ExactMesherFloors, AnyNumberOfThreads) {
  const SphereSet spheres = strip(0.01, 0.2, 0.45);
  const IndexedMeshHash all = hash(mesh_at(spheres, 0.3).mesh);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(hash(mesh_at(spheres, 0.3).mesh), all);
}

}  // namespace
}  // namespace vdwmesh::testing
