// Triangles of a patch on the unit sphere as plain arrays: their smoothing and their defects.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/patch_boundary.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kNoNeighbor = 0xffffffffu;
inline constexpr std::uint32_t kNoPiece = 0xffffffffu;

// Edge k of a triangle is opposite to its vertex k; it has a piece of the boundary or a neighbour.
struct PatchTriangle {
  std::array<std::uint32_t, 3> vertices, neighbors, pieces;
};

// Points: those of the boundary, then the interior ones; directions.
struct PatchTriangles {
  std::vector<Vec3d> points;
  std::vector<PatchTriangle> triangles;
};

// Moves the interior points to the middle of their triangles where the least angle around them
// grows, and flips edges until they are Delaunay; `passes` times. No edge between two points of one
// circle is made.
void smooth(const PatchBoundary& boundary, const PointCircles& circles, int passes,
            PatchTriangles& patch);

// Pieces of triangles that face inwards, and of those that would fold when the piece's arc replaces
// its chord. Ascending, each once.
std::vector<std::uint32_t> defects(const PatchBoundary& boundary, const PatchTriangles& patch);

}  // namespace vdwmesh
