// The signs of a brick's nodes as bits, and what follows from them by bit operations: which grid
// edges carry a vertex, the number of that vertex within its row, the marching-cubes case of each
// cell, and the faces through which the surface leaves the brick. The last part has the lattice:
// where the nodes of a brick lie in the grid, and how many bricks a grid has. For host and device,
// so that both number the mesh alike.
//
// Numbering: a brick owns 8 x 8 rows of 8 nodes along x. Each crossed edge carries one vertex and
// belongs to the node at its lower end. Vertices are numbered row by row, y faster than z, and
// within a row by node, then by axis.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// The number of nodes, along one axis, that the cells of a brick touch: its own 8 nodes, 0 .. 7,
// and the halo node 8, which is the first node of the next brick.
inline constexpr int kBrickReach = kBrickSide + 1;

// Bit x of row[z][y] is set if node (x, y, z) of the brick is inside the surface. x, y and z run
// from 0 to 8.
struct BrickSigns {
  std::uint16_t row[kBrickReach][kBrickReach];
};

// The crossed edges of the nodes x = 0 .. 7 of one row: one byte of bits for each axis, because a
// row has kBrickSide = 8 nodes.
struct RowCrossings {
  std::uint32_t packed;  // bit 8 * axis + x: the edge of node x along the axis is crossed

  VDWMESH_HD std::uint32_t along(int axis) const { return packed >> (8 * axis) & 255u; }
  // Whether the edge from node x one step up along the axis carries a vertex.
  VDWMESH_HD bool has(int x, int axis) const { return (packed >> (8 * axis + x) & 1u) != 0; }
  // Bit x is set if at least one of node x's three edges carries a vertex.
  VDWMESH_HD std::uint32_t nodes() const { return along(0) | along(1) | along(2); }
};

// An edge is crossed if the signs of its ends differ, so three exclusive ors find all edges of a
// row.
VDWMESH_HD inline RowCrossings row_crossings(const BrickSigns& s, int y, int z) {
  const std::uint32_t row = s.row[z][y];
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return {((row ^ (row >> 1)) & own) | ((row ^ s.row[z][y + 1]) & own) << 8 |
          ((row ^ s.row[z + 1][y]) & own) << 16};
}

VDWMESH_HD inline int vertex_count(const RowCrossings& c) { return count_bits(c.packed); }

// Mask of the bits of RowCrossings::packed whose vertices have smaller numbers than the vertex on
// node x's edge along `axis`: all edges of the nodes below x, and the edges of node x along lower
// axes.
VDWMESH_HD inline std::uint32_t crossings_before(int x, int axis) {
  constexpr std::uint32_t each_axis = 0x010101;
  const std::uint32_t lower_nodes = each_axis * ((1u << x) - 1);
  const std::uint32_t lower_axes = (each_axis << x) & ((1u << (8 * axis)) - 1);
  return lower_nodes | lower_axes;
}

// The case of the cell whose lower corner is node (x, y, z), x, y and z from 0 to 7. Bit c of the
// case is the sign of corner c = dx + 2 dy + 4 dz, the node at the offset (dx, dy, dz). So the
// signs of nodes x and x + 1 of one row are two neighbouring bits of the case.
VDWMESH_HD inline std::uint32_t cell_case(const BrickSigns& s, int x, int y, int z) {
  const auto pair = [&](int dy, int dz) {
    return static_cast<std::uint32_t>(s.row[z + dz][y + dy] >> x) & 3u;
  };
  return pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
}

// Bit x is set if the surface crosses cell x = 0 .. 7 of the row. Bit x of `any` is set if one of
// the four nodes at x is inside, and bit x of `all` if all four are. A cell is crossed if `any` has
// a bit at x or x + 1 (some corner is inside) and `all` lacks one of them (some corner is outside).
VDWMESH_HD inline std::uint32_t mixed_cells(const BrickSigns& s, int y, int z) {
  const std::uint32_t a = s.row[z][y], b = s.row[z][y + 1], c = s.row[z + 1][y],
                      d = s.row[z + 1][y + 1];
  const std::uint32_t any = a | b | c | d, all = a & b & c & d;
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return (any | any >> 1) & ~(all & all >> 1) & own;
}

// The faces of a brick that the surface crosses: some of their 9 x 9 nodes are inside and some
// outside. The brick beyond such a face touches the same nodes, so it holds surface too.
struct CrossedFaces {
  std::uint32_t lower, upper;  // bits 0, 1, 2: the face across x, y, z at node 0, or at node 8
};

inline CrossedFaces crossed_faces(const BrickSigns& s) {
  constexpr std::uint32_t all_nodes = (1u << kBrickReach) - 1;  // of a row
  // Collects rows. Bit x of `any` is set if node x is inside in some row, bit x of `all` if it is
  // inside in all rows.
  struct Nodes {
    std::uint32_t any = 0, all = all_nodes;
    void add(std::uint32_t row) {
      any |= row;
      all &= row;
    }
    // Bit x: whether node x is inside in some rows, but not in all.
    std::uint32_t mixed_by_x() const { return any & ~all; }
    // 1 if the nodes of all collected rows together, whatever their x, are of both signs.
    std::uint32_t has_both_signs() const { return any != 0 && all != all_nodes ? 1u : 0u; }
  };
  // layer: the rows of each z. front, back: the rows with y = 0 and y = 8. whole: all rows; its
  // bits 0 and 8 are the two faces across x.
  Nodes layer[kBrickReach], front, back, whole;
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) layer[z].add(s.row[z][y]);
    front.add(s.row[z][0]);
    back.add(s.row[z][kBrickSide]);
    whole.any |= layer[z].any;
    whole.all &= layer[z].all;
  }
  const std::uint32_t x = whole.mixed_by_x();
  return {(x & 1u) | front.has_both_signs() << 1 | layer[0].has_both_signs() << 2,
          (x >> kBrickSide & 1u) | back.has_both_signs() << 1 |
              layer[kBrickSide].has_both_signs() << 2};
}

// The lattice consists of the grid's nodes and one virtual layer of nodes around them. Along an
// axis, grid node i has the lattice index i + 1, and bricks divide the lattice, not the grid.
// Returns the lattice index of node `local` = 0 .. 8 of the brick with index `brick`.
VDWMESH_HD inline std::int64_t lattice_index(std::int32_t brick, int local) {
  return static_cast<std::int64_t>(brick) * kBrickSide + local;
}

// Whether the nodes with this lattice index do not belong to the grid. They lie in the virtual
// layer or, since whole bricks are used, beyond it.
VDWMESH_HD inline bool is_virtual(const GridSpec& grid, int axis, std::int64_t lattice) {
  return lattice < 1 || lattice > grid.cells[axis] + 1;
}

// The coordinate along the axis of the nodes with this lattice index, Å.
VDWMESH_HD inline double lattice_coordinate(const GridSpec& grid, int axis, std::int64_t lattice) {
  return node_coordinate(grid.origin[axis], grid.spacing, lattice - 1);
}

// Number of bricks along an axis, rounded up: they hold the cells + 1 nodes of the grid and the 2
// virtual nodes.
VDWMESH_HD inline std::int32_t brick_count(std::int64_t cells) {
  return static_cast<std::int32_t>((cells + 3 + kBrickSide - 1) / kBrickSide);
}

// Whether a block of 2^level bricks along each axis may have bricks in the range; `block` is its
// index among the blocks of that level. A key grows with each of the three indices, so the first
// and the last brick of the block have the smallest and the largest of its keys. The test is
// one-sided: if it is false, no brick of the block is in the range. If it is true, one may be,
// since between the keys of a large block there are keys of other blocks; for level 0 it is exact.
// `last` is the offset of the block's last brick from its first.
VDWMESH_HD inline bool block_meets(const KeyRange& range, const BrickIndex& block, int level) {
  const BrickIndex first{block.x << level, block.y << level, block.z << level};
  const std::int32_t last = (1 << level) - 1;
  return brick_key({first.x + last, first.y + last, first.z + last}) >= range.begin &&
         brick_key(first) < range.end;
}

}  // namespace vdwmesh
