// Topology, measures and quality of a mesh that all ranks made together.
#pragma once

#include "analysis/mesh_measures.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"

namespace vdwmesh {

// Returns on the first rank what examine() returns for the mesh of all pieces, bit for bit. On
// other ranks the result has no meaning. Meanwhile positions and triangles of other ranks stand
// behind those of the piece, for which its arrays may have to move (take_border_mesh()). Throws
// InternalError, on all ranks, if the mesh is no closed, oriented 2-manifold. Collective.
MeshExamination examine_together(const Ranks& ranks, SurfacePiece& piece);

}  // namespace vdwmesh
