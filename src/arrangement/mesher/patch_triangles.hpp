// The triangles of a patch on the unit sphere as plain arrays. Declares the smoothing of the
// triangles, and the search for pieces of the boundary that must be split because triangles are not
// valid.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/mesher/linked_triangle.hpp"
#include "arrangement/mesher/patch_boundary.hpp"

namespace vdwmesh {

// The points are unit vectors: first the points of the boundary, in its order, then the interior
// ones. Triangles are counter-clockwise seen from outside. Each edge has either a neighbouring
// triangle or a piece of the boundary (an index into PatchBoundary::pieces), never both.
struct PatchTriangles {
  std::vector<Vec3d> points;
  std::vector<LinkedTriangle> triangles;
};

// Memory for smooth(), kept for the next patch.
struct SmoothingScratch {
  // Triangles around vertex v: star[first[v]] .. star[first[v + 1] - 1].
  std::vector<std::uint32_t> first, star;
  // Triangles that flips have made, and those of the sweep before.
  std::vector<std::uint32_t> changed, sweep;
};

// Improves the triangles, which should be Delaunay, without moving the boundary. Does `passes`
// times: it moves each interior point towards the centroid of the triangles around it if this
// enlarges the least angle there, and flips edges until they are locally Delaunay, or a limit of
// flips is reached. A flip never makes an edge between two points of one circle. Triangles that
// face outwards keep doing so.
void smooth(const PatchBoundary& boundary, const PointCircles& circles, int passes,
            SmoothingScratch& scratch, PatchTriangles& patch);

// The pieces that must be split because a triangle is not valid, ascending, each once. A triangle
// is not valid if it faces inwards, or if it would fold over when the arcs beside it replace their
// chords. Subdivision of the mesh (refine/) replaces them step by step, so such triangles would
// turn.
std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch);

}  // namespace vdwmesh
