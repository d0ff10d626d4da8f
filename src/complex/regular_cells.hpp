// The cells of a regular triangulation of some balls. For the library's own use.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

// The vertices of a cell, as indices of balls, in canonical order: ascending, but for the last two,
// which are exchanged if the cell is positively oriented only then. So the lowest vertex is the
// first one, and two lists have the same cell exactly if they have equal arrays.
using CellVertices = std::array<std::uint32_t, 4>;

// Sorts the vertices of a simplex, ascending, and returns whether that was an odd permutation.
template <std::size_t N>
bool sort_is_odd(std::array<std::uint32_t, N>& vertices) {
  bool odd = false;
  for (std::size_t sorted = 1; sorted < N; ++sorted) {
    for (std::size_t i = sorted; i > 0 && vertices[i] < vertices[i - 1]; --i) {
      std::swap(vertices[i], vertices[i - 1]);
      odd = !odd;
    }
  }
  return odd;
}

// The vertices of a positively oriented cell in canonical order. An odd number of exchanges sorts
// them: then two of the sorted vertices are exchanged.
inline CellVertices canonical(CellVertices vertices) {
  if (sort_is_odd(vertices)) std::swap(vertices[2], vertices[3]);
  return vertices;
}

struct RegularCells {
  Buffer<CellVertices> cells;
  // For each vertex of a cell the index of the cell opposite to it; kNoIndex: not in the list.
  Buffer<std::array<std::uint32_t, 4>> neighbors;
};

// Whether a cell belongs in the list.
using TakesCell = std::function<bool(const CellVertices&)>;

// Triangulates the balls of the given indices, in whatever order, with all four auxiliary points,
// which have the indices from balls.size() on. Writes 1 to has_vertex[i] for each ball i that is
// not hidden by others. The cells' order depends on the order of the indices, the cells do not:
// ties, five balls that have one orthogonal sphere, are decided the same way in every subset
// (conflict_side()). Preconditions: no two centres are equal, and no radius is above 1.
// Throws LimitExceeded if there are 2^32 - 1 cells or more, or if they need more memory than the
// limit, and Cancelled.
RegularCells regular_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                           std::span<const std::uint32_t> indices, const TakesCell& takes,
                           std::vector<std::uint8_t>& has_vertex, std::uint64_t memory_limit,
                           Monitor* monitor);

// Refuses so many cells of a triangulation of so many balls if these are more than usual and need
// more memory than the limit (bytes), with the dual complex and all else that there is for each
// cell.
void check_cells(std::uint64_t cells, std::size_t balls, std::uint64_t memory_limit);

}  // namespace vdwmesh
