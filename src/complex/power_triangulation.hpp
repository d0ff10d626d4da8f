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
#include "core/monitor.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct PowerTriangulation : PlacedBalls {
  // For each cell its vertices, positively oriented and otherwise ascending, and for each vertex
  // the neighbouring cell opposite to it (kNoIndex: none). A vertex is an index into
  // `PlacedBalls::balls`; four further indices from balls.size() on are the auxiliary points. A
  // ball that the weights hide is a vertex of no cell.
  Buffer<std::array<std::uint32_t, 4>> cells, neighbors;

  bool is_ball(std::uint32_t vertex) const { return vertex < balls.size(); }
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
