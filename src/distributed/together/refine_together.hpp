// Subdivision and projection of a mesh that all ranks have made together.
#pragma once

#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "refine/refiner.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Replaces the pieces of all ranks by those of the mesh that Refiner::refine() makes of the whole
// mesh, bit for bit, and returns the counts of its levels, on all ranks. Every rank has all
// spheres. The options must be the same on all ranks, and `memory_limit` is that of one rank; no
// observer, frame, workspace or device is looked at. Ranks do not look for triangles that cross:
// with Crossings::undo a projection throws InvalidInput. Throws else what Refiner::refine() throws,
// on all ranks. The result does not depend on the number of ranks. Collective.
std::vector<ProjectionStats> refine_together(const Ranks& ranks, const SphereSet& spheres,
                                             const RefineOptions& options, SurfacePiece& piece);

}  // namespace vdwmesh
