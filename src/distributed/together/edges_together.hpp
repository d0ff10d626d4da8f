// The edges of a mesh of all ranks, numbered as one process numbers them, and the triangles of the
// next level of a refinement.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"

namespace vdwmesh {

// Half-edge h of the piece is half-edge 3 first_triangle + h of the whole mesh. Edges are numbered
// in the order of their lower half-edges, and belong to the ranks that own these.
struct NumberedEdges {
  // By half-edge of the piece: the place of its edge among the own edges, which are [0, own) in the
  // order of their numbers, or `own` + i for the edge elsewhere[i] of another rank.
  Buffer<std::uint32_t> edge;
  // By half-edge: 1 if it is the lower one of its edge, which is then own.
  Buffer<std::uint8_t> is_lower;
  std::uint32_t own = 0;
  std::uint64_t first = 0;               // the number of the first own edge in the whole mesh
  std::vector<std::uint64_t> elsewhere;  // numbers in the whole mesh, ascending
  // By half-edge, if triangles have labels: the sphere of the triangle on the other side.
  Buffer<SphereId> other_sphere;
};

// Throws InternalError, on all ranks, if the mesh is not closed and oriented. Collective.
NumberedEdges number_edges_together(const Ranks& ranks, const SurfacePiece& piece);

// Replaces each triangle of the piece by its four children, and makes the midpoints of its own
// edges a generation of vertices: rank r owns counts[r] of them. Their positions and labels are
// still to be made. Throws LimitExceeded past 2^32 vertices of a rank.
void make_children(const NumberedEdges& edges, std::span<const std::uint64_t> counts,
                   SurfacePiece& piece);

}  // namespace vdwmesh
