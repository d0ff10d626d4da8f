// The area and volume of the curved surface that an inscribed mesh stands for, from the mesh alone.
//
// Seen from its sphere's centre, a triangle covers a spherical triangle between great circles. A
// patch of the union is bounded by arcs of small circles instead: beside each edge between two
// spheres lies a lens between the great circle through its ends and the circle the spheres share.
// Spherical triangles less lenses are the patch. The same holds for cones over them, so a mesh with
// every patch in place gives the exact area and volume of the union to rounding, at any edge
// length.
#pragma once

#include <vector>

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

struct CurvedMeasures {
  std::vector<double> area;  // Å², per sphere of the set
  double volume = 0;         // Å³
};

// `flat_volume` is what the triangles enclose. Preconditions: a closed mesh with triangle_spheres;
// its edges between triangles of two spheres lie on the circle of those two.
CurvedMeasures curved_measures(const SphereSet& spheres, const IndexedMesh& mesh,
                               double flat_volume);

}  // namespace vdwmesh::testing
