// The triangles of the next level of a refinement by all ranks.
#pragma once

#include <cstdint>
#include <span>

#include "distributed/shares/surface_piece.hpp"
#include "distributed/together/edges_together.hpp"

namespace vdwmesh {

// Replaces each triangle of the piece by its four children, and makes the midpoints of its own
// edges a generation of vertices: rank r owns counts[r] of them. Their positions and labels are
// still to be made. Throws LimitExceeded past 2^32 vertices of a rank.
void make_children(const NumberedEdges& edges, std::span<const std::uint64_t> counts,
                   SurfacePiece& piece);

}  // namespace vdwmesh
