// Room for the elements of a SurfaceMesh. Most of the time of OpenMesh's resize() is the kernel's,
// handing out pages one by one to one thread.
#pragma once

#include <cstddef>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

struct ElementCounts {
  std::size_t vertices = 0, edges = 0, faces = 0;
};

// As mesh.resize(), on all cores and in large pages; nothing to do where the mesh has that size.
void make_room(SurfaceMesh& mesh, const ElementCounts& counts);

}  // namespace vdwmesh
