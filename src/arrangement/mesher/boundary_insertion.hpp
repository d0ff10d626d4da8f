// The first step of meshing a patch: makes the pieces of its boundary edges of a triangulation in
// the plane, or finds the pieces that have to be split before that is possible.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_mesher.hpp"
#include "arrangement/mesher/stereographic.hpp"

namespace vdwmesh {

// Triangulates the boundary of a patch in scratch.plane. If the last round could triangulate it,
// only the pieces that were split since then are inserted. Returns the pieces to be split, some of
// them more than once: those that cross, that join the same points, or that have a point on them.
// If there are none, all pieces are edges of the triangulation, and `progress` keeps it for the
// next round. The scratch memory must have the circles of the boundary. Throws CoincidentPoints,
// Cancelled.
std::vector<std::uint32_t> insert_boundary(PatchProgress& progress, const Stereographic& projection,
                                           const PatchOptions& options, PatchScratch& scratch);

}  // namespace vdwmesh
