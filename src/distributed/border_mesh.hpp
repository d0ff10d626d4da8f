// The part of a mesh that a rank measures or refines: its own piece, and around that what the
// pieces of other ranks have at its vertices.
#pragma once

#include <cstddef>

#include "analysis/mesh_part.hpp"
#include "distributed/halo.hpp"
#include "distributed/ranks.hpp"
#include "distributed/surface_piece.hpp"

namespace vdwmesh {

struct BorderMesh {
  // Positions and triangles; see MeshPart. Vertices are in the order of their owners, and those of
  // one owner in the order of their numbers.
  IndexedMesh mesh;
  std::size_t first_vertex = 0, end_vertex = 0, triangles = 0;
  Halo halo;

  MeshPart part() const { return {mesh, first_vertex, end_vertex, triangles}; }
};

// Makes the part of each rank. Copies the positions and triangles of the piece. Collective.
BorderMesh make_border_mesh(const Ranks& ranks, const SurfacePiece& piece);

}  // namespace vdwmesh
