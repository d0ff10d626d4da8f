// What balls leave free of one tetrahedron of the triangulation, exactly: for the library's own
// use.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "complex/power_triangulation.hpp"
#include "core/order/sorted_rows.hpp"

namespace vdwmesh {

// Lengths are scaled as in the triangulation. Entry k of the arrays belongs to the face opposite to
// vertex k.
struct CellRemainder {
  double volume = 0;                  // of the tetrahedron less all balls
  double area = 0;                    // of all spheres in the tetrahedron, outside all other balls
  std::array<double, 4> face_area{};  // of the face less all balls
  std::array<double, 4> face_rim{};   // length of the arcs of balls in the face
  std::vector<std::pair<std::uint32_t, double>> ball_area;  // the balls that have parts of `area`
};

// Per ball, ascending: the balls that share an edge of a cell with it, some of them repeatedly.
using BallNeighbors = SortedRows<std::uint32_t>;
BallNeighbors ball_neighbors(const PowerTriangulation& triangulation);

// Precondition: the cell has balls at all its vertices.
CellRemainder cell_remainder(const PowerTriangulation& triangulation,
                             const BallNeighbors& neighbors, std::uint32_t cell);

}  // namespace vdwmesh
