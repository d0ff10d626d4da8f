// The regular triangulation (weighted Delaunay triangulation) of a set of balls, as plain arrays.
//
// Four auxiliary points of radius 0, far outside every ball, are vertices too. They make the
// triangulation three-dimensional for any input, and every simplex of balls has cells all around.
// Their power is positive on all balls, so they do not change the dual complex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "complex/placed_balls.hpp"
#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/no_index.hpp"

namespace vdwmesh {

class Monitor;

// The slot, 0 to 3, of a value that is there: of a vertex among the vertices of a cell, or of a
// cell among its neighbours. Without branches.
inline std::uint32_t slot_of(const std::array<std::uint32_t, 4>& four, std::uint32_t value) {
  return static_cast<std::uint32_t>(four[1] == value) +
         2 * static_cast<std::uint32_t>(four[2] == value) +
         3 * static_cast<std::uint32_t>(four[3] == value);
}

struct PowerTriangulation : PlacedBalls {
  // For each cell its vertices, positively oriented and otherwise ascending, and for each vertex
  // the neighbouring cell opposite to it (kNoIndex: none). A vertex is an index into
  // `PlacedBalls::balls`; four further indices from balls.size() on are the auxiliary points. A
  // ball that the weights hide is a vertex of no cell.
  Buffer<std::array<std::uint32_t, 4>> cells, neighbors;

  bool is_ball(std::uint32_t vertex) const { return vertex < balls.size(); }
  // The slot of a neighbour of cell c: neighbors[c][slot] == neighbor.
  std::size_t slot_of_neighbor(std::uint32_t c, std::uint32_t neighbor) const {
    return slot_of(neighbors[c], neighbor);
  }
  // The vertex of cell c that is not on its facet to a neighbour.
  std::uint32_t apex(std::uint32_t c, std::uint32_t neighbor) const {
    return cells[c][slot_of_neighbor(c, neighbor)];
  }
};

// The vertices of the facet opposite to vertex k of a cell, counter-clockwise seen from vertex k.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kFacetVertices{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

// The six pairs of vertices of a cell, which is a tetrahedron. Pair 5 - p has the two vertices that
// pair p lacks.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kPairs{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// The triangulation is exact for any finite input. It does not depend on the order of the spheres,
// except for their ids, nor on the number of threads.
// `blocks`: into how many blocks the space is divided, which are triangulated side by side; by
// default, as many as there are cores, or fewer for few balls. The result is the same.
// Throws InvalidInput for an empty set or if the extent of the spheres overflows a double,
// LimitExceeded if there are 2^32 - 1 cells or more, or if they, with their dual complex, need more
// memory than the limit (bytes), and Cancelled.
PowerTriangulation triangulate(const SphereSet& spheres, Monitor* monitor = nullptr,
                               std::optional<std::size_t> blocks = std::nullopt,
                               std::uint64_t memory_limit = kNoMemoryLimit);
// The same of balls that are in their places already.
PowerTriangulation triangulate(PlacedBalls&& balls, Monitor* monitor = nullptr,
                               std::optional<std::size_t> blocks = std::nullopt,
                               std::uint64_t memory_limit = kNoMemoryLimit);

}  // namespace vdwmesh
