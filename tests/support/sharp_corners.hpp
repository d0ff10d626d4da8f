// The promise of ExactMeshOptions::min_angle, checked on a crease-exact mesh from the spheres
// alone.
#pragma once

#include <cstdint>
#include <string>

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

// A corner of a patch is sharp if the exact angle between its two arcs there is below 60°. A
// triangle of this patch is excused if all its vertices are within twice the longer one of the two
// mesh edges along these arcs.
struct BoundedAngles {
  double smallest = 180;            // degrees, of the triangles that are not excused
  std::uint64_t below = 0;          // of these, triangles with an angle below the bound
  std::uint64_t below_excused = 0;  // and of those excused
  std::uint64_t sharp_corners = 0;
  std::string text() const;
};
// `degrees`: the bound.
BoundedAngles bounded_angles(const SphereSet& spheres, const IndexedMesh& mesh, double degrees);

}  // namespace vdwmesh::testing
