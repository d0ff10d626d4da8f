// The triangles of a patch on the unit sphere as plain arrays. Declares the smoothing of the
// triangles, and the search for pieces of the boundary that must be split because triangles are not
// valid.
#pragma once

#include <cstdint>
#include <vector>

#include "creases/arcs/point_circles.hpp"
#include "creases/patch/patch_memory.hpp"
#include "creases/plane/linked_triangle.hpp"
#include "creases/plane/row_lists.hpp"

namespace vdwmesh {

// The points are unit vectors: first the points of the boundary, in its order, then the interior
// ones. Triangles are counter-clockwise seen from outside. Each edge has either a neighbouring
// triangle or a piece of the boundary (an index into PatchBoundary::pieces), never both.
template <class Memory>
struct PatchTrianglesOf {
  typename Memory::template Array<Vec3d> points;
  typename Memory::template Array<LinkedTriangle> triangles;
};
using PatchTriangles = PatchTrianglesOf<GrowingMemory>;

// Memory for smooth(), kept for the next patch.
template <class Memory>
struct SmoothingScratchOf {
  RowListsOf<Memory> stars;  // the triangles around each vertex
  // Triangles that flips have made, and those of the sweep before.
  typename Memory::template Array<std::uint32_t> changed, sweep;
};
using SmoothingScratch = SmoothingScratchOf<GrowingMemory>;

// Improves the triangles, which should be Delaunay, without moving the boundary. Does `passes`
// times: it moves each interior point towards the centroid of the triangles around it if this
// enlarges the least angle there, and flips edges until they are locally Delaunay, or a limit of
// flips is reached. A flip never makes an edge between two points of one circle. Triangles that
// face outwards keep doing so.
template <class Memory>
VDWMESH_HD void smooth(const PatchBoundaryView& boundary, const PointCirclesOf<Memory>& circles,
                       int passes, SmoothingScratchOf<Memory>& scratch,
                       PatchTrianglesOf<Memory>& patch);
// Those of the host are compiled in plane_triangulation.cpp.
template <>
void smooth(const PatchBoundaryView& boundary, const PointCircles& circles, int passes,
            SmoothingScratch& scratch, PatchTriangles& patch);

// Appends to `found` the pieces that must be split because a triangle is not valid, in the order of
// triangles and with repetitions. A triangle is not valid if it faces inwards, or if it would fold
// over when the arcs beside it replace their chords. Subdivision of the mesh (refine/) replaces
// them step by step, so such triangles would turn. Returns whether a triangle that faces outwards
// has an angle below kFloorOfAngles.
template <class Memory>
VDWMESH_HD bool find_defects(const PatchBoundaryView& boundary,
                             const PatchTrianglesOf<Memory>& patch,
                             typename Memory::template Array<std::uint32_t>& found);
template <>
bool find_defects<GrowingMemory>(const PatchBoundaryView& boundary, const PatchTriangles& patch,
                                 PatchVector<std::uint32_t>& found);

}  // namespace vdwmesh
