// The marching cubes cases as emit_triangles.cu reads them: 21 bits for a half-edge, one load of 8
// bytes for a triangle. All tables together take 17 KB, which a thread block keeps in shared
// memory: each lane looks up another case, and the first-level cache serves such loads line by
// line.
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

// A half-edge of a case, in the lowest kHalfEdgeBits bits; those above are of other half-edges.
inline constexpr int kHalfEdgeBits = 21;
struct HalfEdgeCode {
  std::uint32_t bits;

  // It starts on the edge that a node owns. Rows of nodes are numbered 9 z + y: this is how far the
  // node's row is behind the row of the cell's lower corner.
  VDWMESH_HD std::uint32_t row() const { return bits & 15u; }
  // 4 * (the node's x less the cell's) + the axis of the edge.
  VDWMESH_HD std::uint32_t column() const { return bits >> 4 & 7u; }
  // Its opposite is in the cell of the shell at this step; 0: in the same cell.
  VDWMESH_HD int step() const { return static_cast<int>(bits << (32 - kHalfEdgeBits)) >> 24; }
  // Which half-edge of that cell the opposite is: its number if it is in the same cell, else
  // kFirstFaceCode plus the place in CaseTable::face_half_edge[case of that cell].
  VDWMESH_HD std::uint32_t opposite() const { return bits >> 7 & 63u; }
};
static_assert(kFirstFaceCode + 24 <= 64 && shell_step(2) < 128 && 3 * kHalfEdgeBits <= 64);
VDWMESH_HD constexpr HalfEdgeCode half_edge_code(std::uint32_t row, std::uint32_t column,
                                                 std::uint32_t opposite, int step) {
  return {row | column << 4 | opposite << 7 | (static_cast<std::uint32_t>(step) & 255u) << 13};
}

struct TriangleCode {
  std::uint64_t bits;  // half-edge k from bit kHalfEdgeBits * k on

  VDWMESH_HD HalfEdgeCode half_edge(int k) const {
    return {static_cast<std::uint32_t>(bits >> kHalfEdgeBits * k)};
  }
};

struct alignas(16) TriangleCodes {
  TriangleCode triangle[256][kMaxCaseTriangles];
  std::uint8_t face_half_edge[256][24];  // of CaseTable
  std::uint8_t count[256];               // CaseTable::triangle_count
  // crossings_before(x % 8, axis) at 4 x + axis, for x = 0 .. 8.
  std::uint32_t before[4 * kBrickReach];
};

TriangleCodes make_triangle_codes(const CaseTable& table);

}  // namespace vdwmesh
