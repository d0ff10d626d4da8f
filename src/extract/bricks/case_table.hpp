// The 256 cases of marching cubes (Lorensen & Cline, SIGGRAPH 1987), generated at compile time.
//
// Corner c of a cell is at the offset (c & 1, c >> 1 & 1, c >> 2) from its lower corner. A case is
// the signs of the eight corners as a number: bit c is set if corner c is inside. Cell edge e runs
// along axis e / 4. It starts at the corner whose offsets along the other two axes, the lower axis
// first, are bit 0 and bit 1 of e % 4. A crossed cell edge carries one vertex, so a corner of a
// triangle is given by a cell edge.
//
// An ambiguous face of a cell has two inside corners, at the ends of a diagonal. In every case the
// surface separates these two corners. So the two cells at the face have the same segments in it,
// and the mesh is closed. No diagonal of a surface polygon lies in a cell face: if both cells at
// the face drew it, four triangles would share one edge and the mesh would not be a manifold.
// Triangles wind counter-clockwise seen from outside.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace vdwmesh {

inline constexpr int kMaxCaseTriangles = 5;

// Half-edge 3 t + k of a case runs from corner k to corner (k + 1) % 3 of its triangle t. Face f of
// a cell is perpendicular to axis f / 2, at the cell's lower side if f is even and at its upper
// side if f is odd. Let u < v be the other two axes. The four cell edges in the face are numbered
// by slots: slots 0 and 1 run along u, at offset 0 and 1 along v; slots 2 and 3 run along v, at
// offset 0 and 1 along u. An edge has the same slot in both cells that share the face.
inline constexpr int kCaseHalfEdges = 3 * kMaxCaseTriangles;
inline constexpr std::uint8_t kFirstFaceCode = 32;  // the first code in another cell, see `across`
inline constexpr std::uint8_t kNoHalfEdge = 255;    // no half-edge of the case

struct CaseTable {
  std::uint8_t triangle_count[256];
  std::uint8_t edges[256][kCaseHalfEdges];  // cell edge at which each half-edge starts
  // Code of each half-edge's opposite. A code below kCaseHalfEdges is a half-edge of the same cell.
  // kFirstFaceCode + 4 f + s is the half-edge in the cell across face f that lies in this face and
  // starts at its slot s.
  std::uint8_t across[256][kCaseHalfEdges];
  // [case][4 f + s]: the half-edge in face f that starts at slot s, or kNoHalfEdge.
  std::uint8_t face_half_edge[256][24];

  VDWMESH_HD std::uint32_t count(std::uint32_t inside) const { return triangle_count[inside]; }
  VDWMESH_HD int across_code(std::uint32_t inside, int h) const { return across[inside][h]; }
  VDWMESH_HD std::uint32_t at_face(std::uint32_t inside, int face, int slot) const {
    return face_half_edge[inside][4 * face + slot];
  }
};

const CaseTable& case_table();

// A cell edge as a grid edge: its lower end, which is the node that owns it, as an offset from the
// cell's lower corner, and its axis.
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
