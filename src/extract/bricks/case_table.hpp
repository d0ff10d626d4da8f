// The 256 cases of marching cubes (Lorensen & Cline, SIGGRAPH 1987), generated at compile time.
//
// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2); bit c of a case is set where that corner is
// inside. Edge e runs along axis e / 4 from the corner whose offsets along the other two axes, in
// rising order, are the bits of e % 4.
//
// On a face with two inside corners across a diagonal the inside corners are separated, from both
// of its cells alike. No triangulation draws a diagonal inside a cell face: two cells would then
// share that edge four times. Triangles wind counter-clockwise seen from outside.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace vdwmesh {

inline constexpr int kMaxCaseTriangles = 5;

// Half-edge 3 t + k of a case runs from corner k to corner k + 1 of its triangle t. Face f of a
// cell is perpendicular to axis f / 2, at the cell's lower (f even) or upper (f odd) side; the four
// cell edges in it have slots 0, 1 (along the first other axis, at the second's offset 0, 1) and 2,
// 3 (along the second, at the first's offset), the same from both of the cells that share the face.
inline constexpr int kCaseHalfEdges = 3 * kMaxCaseTriangles;
inline constexpr std::uint8_t kFirstFaceCode = 32;
inline constexpr std::uint8_t kNoHalfEdge = 255;

// A half-edge in one word: where the node that owns its corner is, that edge's axis, the opposite.
struct PackedHalfEdge {
  std::uint32_t bits;

  VDWMESH_HD int x() const { return static_cast<int>(bits & 1); }
  VDWMESH_HD int y() const { return static_cast<int>(bits >> 1 & 1); }
  VDWMESH_HD int z() const { return static_cast<int>(bits >> 2 & 1); }
  VDWMESH_HD int axis() const { return static_cast<int>(bits >> 3 & 3); }
  VDWMESH_HD std::uint32_t across() const { return bits >> 8; }
};

struct CaseTable {
  std::uint8_t triangle_count[256];
  std::uint8_t edges[256][kCaseHalfEdges];  // cell edge of each corner
  // The opposite half-edge: one of the same cell (< kCaseHalfEdges), or of the cell across face f,
  // where it starts at slot s: kFirstFaceCode + 4 f + s.
  std::uint8_t across[256][kCaseHalfEdges];
  // Half-edge in face f that starts at slot s: [case][4 f + s], or kNoHalfEdge.
  std::uint8_t face_half_edge[256][24];

  PackedHalfEdge half_edge[256][kCaseHalfEdges];  // what edges and across say

  VDWMESH_HD std::uint32_t count(std::uint32_t inside) const { return triangle_count[inside]; }
  VDWMESH_HD int across_code(std::uint32_t inside, int h) const { return across[inside][h]; }
  VDWMESH_HD std::uint32_t at_face(std::uint32_t inside, int face, int slot) const {
    return face_half_edge[inside][4 * face + slot];
  }
};

const CaseTable& case_table();

// Offset from the cell's lower corner of the node that owns the edge, and the edge's axis.
struct CellEdge {
  std::uint8_t x, y, z, axis;
};
VDWMESH_HD constexpr CellEdge cell_edge(int e) {
  const auto low = static_cast<std::uint8_t>(e & 1), high = static_cast<std::uint8_t>(e >> 1 & 1);
  const int axis = e / 4;
  if (axis == 0) return {0, low, high, 0};
  if (axis == 1) return {low, 0, high, 1};
  return {low, high, 0, 2};
}

}  // namespace vdwmesh
