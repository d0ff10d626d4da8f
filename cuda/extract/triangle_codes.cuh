// The marching cubes cases as emit_triangles.cu reads them: one word for a half-edge, one load of
// 16 bytes for a triangle.
//
// The cells of a brick and of the layers beyond its faces make a shell of 10 x 10 x 10 cells, whose
// coordinates are -1 .. 8; its corners and edges are not used. Cells of the shell are numbered by
// shell_cell(), so a neighbour across a face is at the same step from every cell.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

inline constexpr int kShellSide = kBrickSide + 2;
inline constexpr int kShellCells = kShellSide * kShellSide * kShellSide;
// The step from a cell of the shell to the next one along the axis.
VDWMESH_HD constexpr int shell_step(int axis) {
  return axis == 0 ? 1 : (axis == 1 ? kShellSide : kShellSide * kShellSide);
}
VDWMESH_HD constexpr int shell_cell(int x, int y, int z) {
  return (x + 1) * shell_step(0) + (y + 1) * shell_step(1) + (z + 1) * shell_step(2);
}

// A half-edge of a case.
struct HalfEdgeCode {
  std::uint32_t bits;

  // It starts on the edge that a node owns. Rows of nodes are numbered 9 z + y: this is how far the
  // node's row is behind the row of the cell's lower corner.
  VDWMESH_HD std::uint32_t row() const { return bits & 15u; }
  // 4 * (the node's x less the cell's) + the axis of the edge.
  VDWMESH_HD std::uint32_t column() const { return bits >> 4 & 7u; }
  // Its opposite is in the cell of the shell at this step; 0: in the same cell.
  VDWMESH_HD int step() const { return static_cast<int>(bits) >> 24; }
  // Which half-edge of that cell the opposite is: its number if it is in the same cell, else
  // kFirstFaceCode plus the place in CaseTable::face_half_edge[case of that cell].
  VDWMESH_HD std::uint32_t opposite() const { return bits >> 8 & 63u; }
};

struct alignas(16) TriangleCode {
  HalfEdgeCode half_edge[3];
  std::uint32_t unused;
};

struct TriangleCodes {
  TriangleCode triangle[256][kMaxCaseTriangles];
  // crossings_before(x % 8, axis) at 4 x + axis, for x = 0 .. 8.
  std::uint32_t before[4 * kBrickReach];
};

TriangleCodes make_triangle_codes(const CaseTable& table);

}  // namespace vdwmesh
