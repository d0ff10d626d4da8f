// The signs of a brick's nodes as bits, and everything that follows from them by bit operations:
// which grid edges carry a vertex, the number of that vertex within its row, and the marching-cubes
// case of each cell. For host and device, so that both number the mesh alike.
//
// Numbering: a brick owns 8 x 8 rows of 8 nodes along x. Vertices are numbered row by row, y faster
// than z, and within a row by node, then by axis. Their count is a population count of the crossed
// edges.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// Nodes along one axis that the cells of a brick touch: its own 8 nodes and a halo of one, the
// first node of the next brick.
inline constexpr int kBrickReach = kBrickSide + 1;

// Bit x of row[z][y] is set if node (x, y, z) of the brick is inside. x, y and z run from 0 to 8.
struct BrickSigns {
  std::uint16_t row[kBrickReach][kBrickReach];
};

// The crossed edges that the nodes x = 0 .. 7 of one row own, a byte per axis.
struct RowCrossings {
  std::uint32_t packed;  // bit 8 * axis + x: the edge of node x along the axis is crossed

  VDWMESH_HD std::uint32_t along(int axis) const { return packed >> (8 * axis) & 255u; }
  // Whether node x has a vertex on its edge along the axis.
  VDWMESH_HD bool has(int x, int axis) const { return (packed >> (8 * axis + x) & 1u) != 0; }
  // Nodes with a vertex on any of their edges.
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

// The case of the cell whose lower corner is node (x, y, z), x, y and z from 0 to 7. Bit c is the
// sign of corner c as case_table.hpp numbers corners, so two neighbouring bits of a row are two
// corners.
VDWMESH_HD inline std::uint32_t cell_case(const BrickSigns& s, int x, int y, int z) {
  const auto pair = [&](int dy, int dz) {
    return static_cast<std::uint32_t>(s.row[z + dz][y + dy] >> x) & 3u;
  };
  return pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
}

// Bit x is set if the surface crosses cell x = 0 .. 7 of the row, that is, if the cell's eight
// corners are neither all outside (`any` has no bit) nor all inside (`all` has every bit).
VDWMESH_HD inline std::uint32_t mixed_cells(const BrickSigns& s, int y, int z) {
  const std::uint32_t a = s.row[z][y], b = s.row[z][y + 1], c = s.row[z + 1][y],
                      d = s.row[z + 1][y + 1];
  const std::uint32_t any = a | b | c | d, all = a & b & c & d;
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return (any | any >> 1) & ~(all & all >> 1) & own;
}

// The faces of a brick that the surface crosses: their 9 x 9 nodes are of both signs. The brick
// beyond such a face shares these nodes, so it holds surface too.
struct CrossedFaces {
  std::uint32_t lower, upper;  // bits 0, 1, 2: the face across x, y, z at node 0, or at node 8
};

inline CrossedFaces crossed_faces(const BrickSigns& s) {
  constexpr std::uint32_t all = (1u << kBrickReach) - 1;
  // Bit x of `any` is set if node x of some row is inside, bit x of `every` if it is inside in all
  // rows.
  struct Nodes {
    std::uint32_t any = 0, every = all;
    void add(std::uint32_t row) {
      any |= row;
      every &= row;
    }
    std::uint32_t mixed() const { return any & ~every; }
  };
  // layer: the rows of each z. front, back: the rows with y = 0 and y = 8. whole: all rows; its
  // bits 0 and 8 are the two faces across x.
  Nodes layer[kBrickReach], front, back, whole;
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) layer[z].add(s.row[z][y]);
    front.add(s.row[z][0]);
    back.add(s.row[z][kBrickSide]);
    whole.any |= layer[z].any;
    whole.every &= layer[z].every;
  }
  const auto is_mixed = [](const Nodes& n) { return n.any != 0 && n.every != all ? 1u : 0u; };
  const std::uint32_t x = whole.mixed();
  return {(x & 1u) | is_mixed(front) << 1 | is_mixed(layer[0]) << 2,
          (x >> kBrickSide & 1u) | is_mixed(back) << 1 | is_mixed(layer[kBrickSide]) << 2};
}

// The lattice consists of the grid's nodes and one virtual layer of nodes around them: lattice
// index = node + 1. This is the lattice index of node `local` = 0 .. 8 of a brick, along one axis.
VDWMESH_HD inline std::int64_t lattice_index(std::int32_t brick, int local) {
  return static_cast<std::int64_t>(brick) * kBrickSide + local;
}

VDWMESH_HD inline bool is_virtual(const GridSpec& grid, int axis, std::int64_t lattice) {
  return lattice < 1 || lattice > grid.cells[axis] + 1;
}

VDWMESH_HD inline double lattice_coordinate(const GridSpec& grid, int axis, std::int64_t lattice) {
  return node_coordinate(grid.origin[axis], grid.spacing, lattice - 1);
}

// Number of bricks along an axis. They hold the cells + 1 nodes of the grid and the 2 virtual
// nodes.
VDWMESH_HD inline std::int32_t brick_count(std::int64_t cells) {
  return static_cast<std::int32_t>((cells + 3 + kBrickSide - 1) / kBrickSide);
}

// Whether a block of 2^level bricks along each axis may have bricks in the range. Keys grow with
// every index, so the first and the last brick of the block have the smallest and the largest of
// its keys; between them there may be others that are not the block's. For level 0 the answer is
// exact.
VDWMESH_HD inline bool block_meets(const KeyRange& range, const BrickIndex& block, int level) {
  const BrickIndex first{block.x << level, block.y << level, block.z << level};
  const std::int32_t last = (1 << level) - 1;
  return brick_key({first.x + last, first.y + last, first.z + last}) >= range.begin &&
         brick_key(first) < range.end;
}

}  // namespace vdwmesh
