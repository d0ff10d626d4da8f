// The bricks that hold surface as one list: what each holds, how much is before it, and where its
// neighbours stand. Host and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

// A brick after counting.
struct ActiveBrick {
  std::uint64_t key;
  std::uint32_t vertices, triangles, clipped_cells;
  std::uint16_t row_vertices[kBrickSide * kBrickSide];   // vertices before each row of nodes
  std::uint16_t row_triangles[kBrickSide * kBrickSide];  // triangles before each row of cells
  BrickSigns signs;
};

// Vertices and triangles of a brick, or before it.
struct BrickSums {
  std::uint64_t vertices, triangles;
};

// Bricks by rising key, and what is before each; before[size] is the total.
struct BrickList {
  const ActiveBrick* bricks;
  const BrickSums* before;
  std::uint64_t size;
};

// Place of the first brick whose key is not below `key`.
VDWMESH_HD inline std::uint64_t first_not_below(const BrickList& list, std::uint64_t key) {
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

// A brick and its 26 neighbours.
inline constexpr int kNeighbours = 27;
VDWMESH_HD constexpr int neighbour_slot(int dx, int dy, int dz) {
  return (dz + 1) * 9 + (dy + 1) * 3 + dx + 1;
}

// Throws InternalError: the surface leaves the brick for a neighbour that is not in the list.
// Defined apart, so that loops into which everything is inlined do not take the message in too.
[[noreturn]] void throw_missing_neighbour(const BrickIndex& brick);

// The place of a neighbour that holds surface, because the brick with that key shares nodes of both
// signs with it. The search keeps every brick with surface, so the neighbour is in the list; where
// it is not, another brick in its place would make a wrong mesh without a word: throws
// InternalError. Host only; the device has its own search, in emit_triangles.cu.
inline std::uint64_t find_neighbour(const BrickList& list, std::uint64_t key, int slot) {
  const BrickIndex own = brick_of_key(key);
  const BrickIndex b{own.x + slot % 3 - 1, own.y + slot / 3 % 3 - 1, own.z + slot / 9 - 1};
  const std::uint64_t place = first_not_below(list, brick_key(b));
  if (place == list.size || list.bricks[place].key != brick_key(b)) {
    throw_missing_neighbour(own);
  }
  return place;
}

// A node or cell of a brick or of one of its neighbours, as that brick numbers it.
struct Located {
  std::uint64_t brick;
  int x, y, z;
};

// `neighbour(slot)` gives the place of a neighbouring brick; coordinates are those of the brick in
// the middle, -1 to 8.
template <class Neighbour>
VDWMESH_HD Located locate(Neighbour&& neighbour, int x, int y, int z) {
  return {neighbour(neighbour_slot(x >> 3, y >> 3, z >> 3)), x & 7, y & 7, z & 7};
}

// Cells of a row x = 0 .. 7 that have a virtual corner.
VDWMESH_HD inline std::uint32_t border_cells(const BrickGeometry& g, int y, int z) {
  const bool border_row = (g.real[1] >> y & 3) != 3 || (g.real[2] >> z & 3) != 3;
  const std::uint32_t own = (1u << kBrickSide) - 1;
  return border_row ? own : ~(g.real[0] & static_cast<std::uint32_t>(g.real[0]) >> 1) & own;
}

}  // namespace vdwmesh
