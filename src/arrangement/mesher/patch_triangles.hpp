// The triangles of a patch on the unit sphere as plain arrays. Declares the smoothing of the
// triangles, and the search for pieces of the boundary that must be split because triangles are not
// valid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_boundary.hpp"

namespace vdwmesh {

// In place of a neighbour: the edge is a piece of the boundary, so no triangle of the patch lies
// beyond it.
inline constexpr std::uint32_t kNoNeighbor = 0xffffffffu;
// In place of a piece: the edge lies inside the patch.
inline constexpr std::uint32_t kNoPiece = 0xffffffffu;

// Edge k of a triangle is opposite to its vertex k. It has either a neighbouring triangle or a
// piece of the boundary, never both.
struct PatchTriangle {
  // Vertices index PatchTriangles::points, counter-clockwise seen from outside. Neighbours index
  // PatchTriangles::triangles, pieces index PatchBoundary::pieces.
  std::array<std::uint32_t, 3> vertices, neighbors, pieces;
};

// The points are unit vectors: first the points of the boundary, in its order, then the interior
// ones.
struct PatchTriangles {
  std::vector<Vec3d> points;
  std::vector<PatchTriangle> triangles;
};

// Improves the triangles without moving the boundary. Flips edges until they are locally Delaunay,
// or a limit of flips is reached. Then it does `passes` times: it moves each interior point towards
// the centroid of the triangles around it if this enlarges the least angle there, and flips edges
// again. A flip never makes an edge between two points of one circle. Triangles that face outwards
// keep doing so.
void smooth(const PatchBoundary& boundary, const PointCircles& circles, int passes,
            PatchTriangles& patch);

// The pieces that must be split because a triangle is not valid, ascending, each once. A triangle
// is not valid if it faces inwards, or if it would fold over when the arcs beside it replace their
// chords. Subdivision of the mesh (refine/) replaces them step by step, so such triangles would
// turn.
std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch);

}  // namespace vdwmesh
