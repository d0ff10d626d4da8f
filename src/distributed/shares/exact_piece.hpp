// The crease-exact mesh of all ranks together. Every rank arranges a run of balls and those that
// touch them, or all balls if features of the set have no size, and meshes the patches of its run
// only. All of them stand behind each other as the mesh that one process makes, bit for bit. No
// rank holds the whole mesh.
#pragma once

#include "creases/exact_mesher.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"

namespace vdwmesh {

struct ExactPiece {
  SurfacePiece piece;    // with triangle_spheres
  ExactMeshStats stats;  // of the whole mesh; the times are of this rank
};

// Makes the mesh of mesh_union(). Every rank has all spheres, and the options are the same on all,
// but for the memory limit and the monitor, which are a rank's own. Throws, on all ranks, what
// mesh_union() throws. Collective.
ExactPiece mesh_union_together(const Ranks& ranks, const SphereSet& spheres,
                               const ExactMeshOptions& options);

}  // namespace vdwmesh
