// What the crease-exact mesher's contract tests share.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "contract/extractor_contract.hpp"
#include "creases/exact_mesher.hpp"
#include "measures/exact_union.hpp"
#include "refine/refiner.hpp"
#include "support/crease_survey.hpp"
#include "support/sphere_recipes.hpp"
#include "support/union_verdict.hpp"

namespace vdwmesh::testing {

// Three or more balls that meet in one exposed point leave a boundary that is no surface there, and
// what is too small for coordinates is made points: then the mesh may have another topology, by as
// much as the mesher has announced.
enum class Topology : std::uint8_t { exact, parted };

struct Demands {
  // Å: from each vertex to its spheres, and into a ball. The contract's; features up to
  // FeatureSizes may be left out, which shows as a distance.
  double distance = 1e-9;
  Topology topology = Topology::exact;
  // Meshes with more triangles are not searched, for time.
  std::uint64_t largest_searched = 300'000;
  // What the mesher announced, for Topology::parted.
  std::int64_t euler_difference = 0, shell_difference = 0;
};

// Runs on one backend, that of the parameter. A device gets all patches, however few they are.
class ExactMesherContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override;
  void TearDown() override;
};

// Meshes on the backend of the running test; of a test without a backend on the CPU.
ExactMesh mesh_with(const SphereSet& spheres, ExactMeshOptions options);
ExactMesh mesh_at(const SphereSet& spheres, double edge_length);
IndexedMesh subdivided(const SphereSet& spheres, const IndexedMesh& mesh, int levels,
                       const Demands& demands = {});

// Everything the contract says of one mesh of the union, of any level.
void expect_union_mesh(const SphereSet& spheres, const IndexedMesh& mesh, const ExactUnion& exact,
                       const Demands& demands);

// What to demand of the mesh of a set of any kind: one that is nearly degenerate has the topology
// that the mesher has announced. Nothing is searched for self-intersections, for time.
Demands demands_of_set(const SeededSet& set, const ExactMeshStats& stats);

// The same of mesh_at() and of its subdivisions. Returns the mesh before them.
IndexedMesh expect_union_meshes(const SphereSet& spheres, double edge_length, int levels,
                                const Demands& demands = {});

// Balls at the corners of regular bodies inscribed in a sphere.
SphereSet cage(const std::vector<Vec3d>& directions, double cage_radius, double ball_radius);
std::vector<Vec3d> octahedron_corners();
std::vector<Vec3d> icosahedron_corners();

}  // namespace vdwmesh::testing
