// The marching-cubes polygons of one cell, found from its faces.
#pragma once

#include <array>
#include <vector>

namespace vdwmesh::reference {

// Corner c of a cell lies at (c & 1, c >> 1 & 1, c >> 2 & 1). An edge is the pair of its corners,
// the lower first.
struct CellEdge {
  int a, b;
};
const std::array<CellEdge, 12>& cell_edges();

// Triangles (three indices into cell_edges() each) for the corners whose bit in `inside` is set,
// counter-clockwise seen from outside. On a face with two inside corners across a diagonal these
// are separated. No triangle has a side inside a cell face other than the face's own segments.
const std::vector<std::array<int, 3>>& cell_triangles(unsigned inside);

}  // namespace vdwmesh::reference
