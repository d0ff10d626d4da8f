// The triangles of a patch on the unit sphere as plain arrays; how they are smoothed, and which
// pieces of the boundary must be split because triangles are not valid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_boundary.hpp"

namespace vdwmesh {

// The edge is a piece of the boundary, so no triangle of the patch lies beyond it.
inline constexpr std::uint32_t kNoNeighbor = 0xffffffffu;
// The edge lies inside the patch.
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

// Improves the triangles without moving the boundary. Flips edges until they are Delaunay, then
// repeats `passes` times: each interior point moves towards the centroid of the triangles around it
// if this enlarges the least angle there, and edges are flipped again. A flip never makes an edge
// between two points of one circle. Triangles that face outwards keep doing so.
void smooth(const PatchBoundary& boundary, const PointCircles& circles, int passes,
            PatchTriangles& patch);

// The pieces that must be split because a triangle is not valid, ascending, each once. A triangle
// is not valid if it faces inwards, or if it would fold over when the arcs beside it replace their
// chords. Subdivision does replace them step by step.
std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch);

}  // namespace vdwmesh
