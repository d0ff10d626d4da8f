// Triangles that cannot intersect because they lie in different cells of a grid: what marching
// cubes leaves to the search for self-intersections.
//
// Nothing is taken on trust: the coordinates of the vertices are compared with the planes of the
// lattice, bit by bit. The planes of an axis are doubles that never fall, so they divide space into
// boxes, the cells, whose coordinates are exact. Let all of this be found:
//   1. Every vertex lies strictly within a grid edge: two of its coordinates are planes, the third
//      is strictly between two consecutive ones.
//   2. Every triangle has its vertices on three edges of one cell.
//   3. The numbers of edges on which the triangles of a cell have vertices, added up over all
//      cells, are four times the number of vertices.
//   4. If a side of a triangle joins two opposite edges of a face of its cell, no triangle of the
//      cell has a vertex on the other two edges of this face.
// The lattice has no end; how many cells the grid has does not matter.
//
// No triangle lies in a face: of three edges of a face two are opposite, which 4 forbids. Four
// cells are around a grid edge, so the sum in 3 is at most four times the number of edges that have
// vertices. As it is four times the number of vertices, every vertex has an edge of its own, and
// triangles in all four cells around it.
//
// Planes whose coordinates are rounded to the same number do no harm. The index of a vertex's plane
// depends on the coordinate alone, so a cell between two such planes has vertices in one of the two
// faces only and, as nothing is strictly between them, no triangle. A vertex in a face of this cell
// would thus lack one of its four cells. So where planes are one, no vertex is: cells that meet
// there have no triangles that reach there, and all cells with triangles are boxes.
//
// Then two triangles of different cells have nothing in common but a vertex or a side that they
// share by index, so no such pair counts as an intersection. A cell is convex, so what a triangle
// has in one of its faces, edges or corners is the hull of the vertices that lie there: by 1 and 2
// nothing, a vertex, or a side whose ends lie on two edges of a face. What two triangles of
// different cells have in common lies in a face, an edge or a corner of both cells.
//   - No triangle reaches a corner. On an edge there is one vertex, which both have or not.
//   - In a face, a side lies in the interior of the rectangle but for its ends, which are on two
//     edges. So a vertex meets a side in its ends only. Two sides that join the same two edges are
//     the same. Two that have one edge in common have one end in common, and lie on different
//     lines, because a line meets the border of a rectangle in two points unless it follows an
//     edge. Two that cut off opposite corners, (0, 0) and (1, 1), are apart: one lies on the line
//     x / a + y / b = 1 with a, b < 1, and both ends of the other, (1, c) and (d, 1), lie beyond.
//     What is left are two sides of which one joins two opposite edges, and one the other two. But
//     the cell of the first side has triangles with the vertices on the other two edges, by 3, and
//     has none, by 4. ∎
//
// No triangle is flat. If a line had all three vertices, the middle one would be on an edge, thus
// in two faces of the cell; and a line through a point of a face that does not lie in it leaves the
// cell there, so all three would be in that face.
//
// That no other triangle of a cell comes later is seen from the order of cells: marching cubes
// emits them brick by brick (extract/bricks/brick.hpp), and what rises strictly does not come back.
#pragma once

#include <optional>

#include "analysis/mesh_measures.hpp"
#include "extract/grid.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;

// The pairs of triangles that intersect, as intersecting_pairs() defines them but in no particular
// order, if the mesh lies in the cells of the grid as is said above; otherwise nothing. Takes
// linear time, and 8 bytes per vertex. Throws Cancelled if the monitor asks for it.
std::optional<TrianglePairs> pairs_within_cells(const IndexedMesh& mesh, const GridSpec& grid,
                                                Monitor* monitor);

}  // namespace vdwmesh
