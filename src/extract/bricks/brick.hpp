// A brick's node signs and what follows from them by counting bits: which grid edges carry a
// vertex, its number within the brick, and the case of each cell. For host and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// Nodes that the cells of a brick touch, along one axis: its own and the first of the next brick.
inline constexpr int kBrickReach = kBrickSide + 1;

// Bit x of row[z][y]: node (x, y, z) of the brick is inside.
struct BrickSigns {
  std::uint16_t row[kBrickReach][kBrickReach];
};

// Nodes x = 0 .. 7 of a row whose edge along each axis crosses the surface: a byte per axis.
struct RowCrossings {
  std::uint32_t packed;

  VDWMESH_HD std::uint32_t along(int axis) const { return packed >> (8 * axis) & 255u; }
  // Whether node x has a vertex on its edge along the axis.
  VDWMESH_HD bool has(int x, int axis) const { return (packed >> (8 * axis + x) & 1u) != 0; }
  // Nodes with a vertex on any of their edges.
  VDWMESH_HD std::uint32_t nodes() const { return along(0) | along(1) | along(2); }
};

VDWMESH_HD inline RowCrossings row_crossings(const BrickSigns& s, int y, int z) {
  const std::uint32_t row = s.row[z][y];
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return {((row ^ (row >> 1)) & own) | ((row ^ s.row[z][y + 1]) & own) << 8 |
          ((row ^ s.row[z + 1][y]) & own) << 16};
}

VDWMESH_HD inline int vertex_count(const RowCrossings& c) { return count_bits(c.packed); }

// Bits of RowCrossings that come before node x's edge along `axis`: by node, then axis.
VDWMESH_HD inline std::uint32_t crossings_before(int x, int axis) {
  constexpr std::uint32_t each_axis = 0x010101;
  const std::uint32_t lower_nodes = each_axis * ((1u << x) - 1);
  const std::uint32_t lower_axes = (each_axis << x) & ((1u << (8 * axis)) - 1);
  return lower_nodes | lower_axes;
}

// Place of the vertex of node x's edge along `axis` among those of its row.
VDWMESH_HD inline int place_in_row(const RowCrossings& c, int x, int axis) {
  return count_bits(c.packed & crossings_before(x, axis));
}

// The case of the cell whose lower corner is node (x, y, z): see case_table.hpp.
VDWMESH_HD inline std::uint32_t cell_case(const BrickSigns& s, int x, int y, int z) {
  const auto pair = [&](int dy, int dz) {
    return static_cast<std::uint32_t>(s.row[z + dz][y + dy] >> x) & 3u;
  };
  return pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
}

// Cells x = 0 .. 7 of a row of cells that the surface crosses.
VDWMESH_HD inline std::uint32_t mixed_cells(const BrickSigns& s, int y, int z) {
  const std::uint32_t a = s.row[z][y], b = s.row[z][y + 1], c = s.row[z + 1][y],
                      d = s.row[z + 1][y + 1];
  const std::uint32_t any = a | b | c | d, all = a & b & c & d;
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return (any | any >> 1) & ~(all & all >> 1) & own;
}

// Faces of a brick whose 9 x 9 nodes are of both signs, a bit per axis: the surface crosses them,
// so that the brick beyond holds surface too.
struct CrossedFaces {
  std::uint32_t lower, upper;
};

inline CrossedFaces crossed_faces(const BrickSigns& s) {
  constexpr std::uint32_t all = (1u << kBrickReach) - 1;
  struct Nodes {
    std::uint32_t any = 0, every = all;
    void add(std::uint32_t row) {
      any |= row;
      every &= row;
    }
    std::uint32_t mixed() const { return any & ~every; }
  };
  Nodes layer[kBrickReach], front, back, whole;  // z; y = 0 and 8; x by bit
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

// Lattice: the grid's nodes and the virtual layer around them, lattice index = node + 1.
VDWMESH_HD inline std::int64_t lattice_index(std::int32_t brick, int local) {
  return static_cast<std::int64_t>(brick) * kBrickSide + local;
}

VDWMESH_HD inline bool is_virtual(const GridSpec& grid, int axis, std::int64_t lattice) {
  return lattice < 1 || lattice > grid.cells[axis] + 1;
}

VDWMESH_HD inline double lattice_coordinate(const GridSpec& grid, int axis, std::int64_t lattice) {
  return node_coordinate(grid.origin[axis], grid.spacing, lattice - 1);
}

// Bits x = 0 .. 8 of a row that are nodes of the grid.
VDWMESH_HD inline std::uint16_t real_nodes(const GridSpec& grid, std::int32_t brick_x) {
  std::uint32_t bits = 0;
  for (int x = 0; x < kBrickReach; ++x) {
    if (!is_virtual(grid, 0, lattice_index(brick_x, x))) bits |= 1u << x;
  }
  return static_cast<std::uint16_t>(bits);
}

// Bricks along an axis that hold the grid's nodes and the virtual layer.
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
