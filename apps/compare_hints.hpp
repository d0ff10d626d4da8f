// What a mesh of another program and a molecule may have between them.
#pragma once

#include "mesh/mesh_io.hpp"
#include "report.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// Merges vertices in one place where that closes an open mesh, and notes it; where it does not, a
// warning says that there are such vertices. True where the mesh changed. Nothing is tried that
// needs more than memory_limit bytes.
bool weld_if_that_closes(MeshFile& file, std::uint64_t memory_limit, Report& report);

// Warns of a mesh that is much larger or smaller than the spheres, or lies elsewhere.
void warn_of_place(const IndexedMesh& mesh, const SphereSet& spheres, Report& report);

}  // namespace vdwmesh::apps
