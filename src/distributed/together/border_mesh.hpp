// The part of a mesh that a rank measures or refines: its own piece, and behind that what the
// pieces of other ranks have at its vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/survey/mesh_part.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/halo.hpp"
#include "distributed/shares/surface_piece.hpp"

namespace vdwmesh {

struct BorderMesh {
  // Positions and triangles; see MeshPart. The own vertices have their local numbers, and corners
  // of own triangles are what they are in the piece: vertices of other ranks follow the own ones,
  // first those of SurfacePiece::elsewhere.
  IndexedMesh mesh;
  std::size_t vertices = 0, triangles = 0;  // of the piece
  std::vector<std::uint8_t> is_larger;      // as in MeshPart
  // The own triangles that have a vertex of another rank.
  std::vector<std::size_t> border_triangles;
  Halo halo;

  MeshPart part() const { return {mesh, vertices, triangles, is_larger}; }
};

// Makes the part of each rank. Copies the positions and triangles of the piece. Collective.
BorderMesh copy_border_mesh(const Ranks& ranks, const SurfacePiece& piece);

// The same without a copy: the positions and triangles of the piece are in the part until
// give_back(). Where their arrays have room for what is added (SurfacePiece), they stay where they
// are. Collective.
BorderMesh take_border_mesh(const Ranks& ranks, SurfacePiece& piece);
void give_back(BorderMesh& part, SurfacePiece& piece);

}  // namespace vdwmesh
