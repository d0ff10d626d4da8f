// What a crease-exact mesh owes to the exact union, as numbers.
#pragma once

#include <cstdint>
#include <string>

#include "measures/exact_union.hpp"
#include "support/crease_survey.hpp"

namespace vdwmesh::testing {

// Mesh less union. Balls that touch in one point are apart in a mesh, so that each contact adds 2
// to the Euler characteristic, and components are those of the open balls.
struct TopologyDifference {
  std::int64_t euler_characteristic, components, voids;
  bool none() const { return euler_characteristic == 0 && components == 0 && voids == 0; }
};
TopologyDifference topology_difference(const SphereSet& spheres, const reference::MeshFacts& mesh,
                                       const UnionTopology& exact);

// Differences between the measures of the curved surface that the mesh stands for and the exact
// ones; not finite where one of them is not.
struct MeasureDifference {
  double area;    // the largest of all spheres, by the square of its radius
  double volume;  // by that of the union
};
MeasureDifference measure_difference(const SphereSet& spheres, const IndexedMesh& mesh,
                                     const reference::MeshFacts& facts, const ExactUnion& exact);

}  // namespace vdwmesh::testing
