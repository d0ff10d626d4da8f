// The part of a mesh that a rank measures: its own piece, and around that what the pieces of other
// ranks have at its vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/mesh_part.hpp"
#include "distributed/ranks.hpp"
#include "distributed/surface_piece.hpp"

namespace vdwmesh {

// A vertex of this rank's triangles that another rank owns, or the other way round.
struct BorderVertex {
  int rank;             // the other one
  std::uint32_t local;  // index in BorderMesh::mesh
};

struct BorderMesh {
  IndexedMesh mesh;  // positions and triangles; see MeshPart
  std::size_t first_vertex = 0, end_vertex = 0, triangles = 0;
  // The vertices of own triangles that other ranks own, by rising rank and number.
  std::vector<BorderVertex> elsewhere;
  // The own vertices that are in triangles of other ranks, in the order of the others' `elsewhere`.
  std::vector<BorderVertex> asked_for;

  MeshPart part() const { return {mesh, first_vertex, end_vertex, triangles}; }
};

// Makes the part of each rank. Copies the positions and triangles of the piece. Collective.
BorderMesh make_border_mesh(const Ranks& ranks, const SurfacePiece& piece);

}  // namespace vdwmesh
