// The part of a mesh that a rank measures or refines: its own piece, and behind that what the
// pieces of other ranks have at its vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/survey/mesh_part.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"

namespace vdwmesh {

// The vertices of a rank's part of a mesh that other ranks own, and how they are kept up to date.
struct Halo {
  // [rank]: the vertices of this part that the rank owns, ascending, as indices in the arrays of
  // the part.
  std::vector<std::vector<std::uint32_t>> elsewhere;
  // [rank]: the own vertices that the rank has in its part, in the order of its `elsewhere`.
  std::vector<std::vector<std::uint32_t>> asked_for;

  // Replaces the elements of an array over the vertices of the part that stand for vertices of
  // other ranks by what these ranks have. Collective.
  template <class Array>
  void refresh(const Ranks& ranks, Array& array) const {
    using T = typename Array::value_type;
    std::vector<std::vector<T>> sent(asked_for.size());
    ranks.together([&] {
      for (std::size_t rank = 0; rank < asked_for.size(); ++rank) {
        for (const std::uint32_t v : asked_for[rank]) sent[rank].push_back(array[v]);
      }
    });
    const std::vector<std::vector<T>> received = ranks.exchange(sent);
    for (std::size_t rank = 0; rank < elsewhere.size(); ++rank) {
      for (std::size_t i = 0; i < elsewhere[rank].size(); ++i) {
        array[elsewhere[rank][i]] = received[rank][i];
      }
    }
  }
};

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
