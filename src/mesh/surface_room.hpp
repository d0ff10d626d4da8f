// Allocation of the arrays of a SurfaceMesh, faster than by OpenMesh's resize(). That function runs
// on one thread and spends most of its time in page faults, one for every 4 KiB it writes first.
#pragma once

#include <cstddef>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

// A mesh has two half-edges per edge, so they need no count.
struct ElementCounts {
  std::size_t vertices = 0, edges = 0, faces = 0;
};

// Has the effect of mesh.resize(). An empty mesh gets its arrays in large pages, which all cores
// touch first. Any other mesh is resized by OpenMesh alone, which is free if it has that size.
// Precondition: the mesh has the vertex property of vertex_spheres().
void make_room(SurfaceMesh& mesh, const ElementCounts& counts);

}  // namespace vdwmesh
