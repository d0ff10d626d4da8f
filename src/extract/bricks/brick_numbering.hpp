// The list of the bricks that hold surface (on the device, of all candidates), and how the mesh is
// numbered over it. Every brick is counted on its own. Exclusive prefix sums over the list then
// give the first vertex and the first triangle of each brick, so that bricks can write their parts
// of the mesh in any order and on any number of threads. Neighbours are found by binary search,
// because the list is sorted by key. Host and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

// What counting found in a brick. Rows are numbered 8 z + y.
struct ActiveBrick {
  std::uint64_t key;
  // clipped_cells: cells that the surface crosses and that have a corner outside the grid.
  std::uint32_t vertices, triangles, clipped_cells;
  std::uint16_t row_vertices[kBrickSide * kBrickSide];   // vertices before each row of nodes
  std::uint16_t row_triangles[kBrickSide * kBrickSide];  // triangles before each row of cells
  BrickSigns signs;
};

// Numbers of vertices and triangles: of one brick, or the prefix sums over all bricks before it.
struct BrickSums {
  std::uint64_t vertices, triangles;
};

struct BrickList {
  const ActiveBrick* bricks;  // by rising key
  const BrickSums* before;    // exclusive prefix sums, size + 1 of them; before[size] is the total
  std::uint64_t size;
};

// Index of the first brick whose key is at least `key`, or list.size: a binary search.
VDWMESH_HD inline std::uint64_t lower_bound_of_key(const BrickList& list, std::uint64_t key) {
  std::uint64_t low = 0, high = list.size;
  while (low < high) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (list.bricks[middle].key < key) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

// A brick and its 26 neighbours. The slot of the neighbour at an offset of -1, 0 or 1 along each
// axis is a base-3 number; slot 13 is the brick itself.
inline constexpr int kNeighbours = 27;
VDWMESH_HD constexpr int neighbour_slot(int dx, int dy, int dz) {
  return (dz + 1) * 9 + (dy + 1) * 3 + dx + 1;
}

// Throws InternalError with a message that the surface leaves the brick for a neighbour that is not
// in the list. It is defined in brick_extraction.cpp, so that loops into which everything is
// inlined do not contain the formatting of the message too.
[[noreturn]] void throw_missing_neighbour(const BrickIndex& brick);

// Index in the list of a neighbour of the brick with that key. Precondition: the two share nodes of
// both signs, so that the neighbour holds surface. The brick search keeps every brick with surface,
// so the neighbour is in the list. Throws InternalError if it is not: using another brick instead
// would silently produce a wrong mesh. Host only; the device has its own search in
// emit_triangles.cu.
inline std::uint64_t find_neighbour(const BrickList& list, std::uint64_t key, int slot) {
  const BrickIndex own = brick_of_key(key);
  const BrickIndex b{own.x + slot % 3 - 1, own.y + slot / 3 % 3 - 1, own.z + slot / 9 - 1};
  const std::uint64_t place = lower_bound_of_key(list, brick_key(b));
  if (place == list.size || list.bricks[place].key != brick_key(b)) {
    throw_missing_neighbour(own);
  }
  return place;
}

// A node or a cell by the brick that owns it, and its coordinates in that brick.
struct OwnerPosition {
  std::uint64_t brick;  // index in the brick list
  int x, y, z;          // 0 .. 7
};

// Finds the owner of a node or cell given by coordinates -1 .. 8 relative to some brick. x >> 3 is
// the owner's offset from that brick, -1, 0 or 1. neighbour(slot) gives the index in the list of
// the brick at that offset.
template <class Neighbour>
VDWMESH_HD OwnerPosition locate(Neighbour&& neighbour, int x, int y, int z) {
  return {neighbour(neighbour_slot(x >> 3, y >> 3, z >> 3)), x & 7, y & 7, z & 7};
}

// Bit x is set if cell x = 0 .. 7 of the row (y, z) has a corner that does not belong to the grid.
VDWMESH_HD inline std::uint32_t border_cells(const BrickGeometry& g, int y, int z) {
  const bool border_row = (g.real[1] >> y & 3) != 3 || (g.real[2] >> z & 3) != 3;
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return border_row ? own : ~(g.real[0] & static_cast<std::uint32_t>(g.real[0]) >> 1) & own;
}

}  // namespace vdwmesh
