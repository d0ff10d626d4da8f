// What is commonly wrong if a mesh of another program and its molecule do not fit.
#pragma once

#include "mesh/mesh_io.hpp"
#include "report/report.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// Merges vertices with the same coordinates if that closes an open mesh, and notes it. If it does
// not, warns that there are such vertices. Returns whether the mesh was changed. Does nothing if
// merging would need more than memory_limit bytes.
bool weld_if_that_closes(MeshFile& file, std::uint64_t memory_limit, Report& report);

// Warns of a mesh that is much larger or smaller than the spheres, or lies elsewhere. Returns
// whether it did.
bool warn_of_place(const IndexedMesh& mesh, const SphereSet& spheres, Report& report);

// Warns of a closed mesh with much more volume than the balls, as if it was of another surface.
// Needs the measures of both in the report.
void warn_of_surface(Report& report);

}  // namespace vdwmesh::apps
