// The list of bricks with what counting found in each, and how the mesh is numbered over this list.
// On the CPU the list has the bricks that hold surface. On the device it has all candidates of the
// brick search; those without surface have counts of 0.
//
// Each brick is counted independently of the others. Exclusive prefix sums over the list then give
// the numbers of the first vertex and the first triangle of each brick, so bricks can write their
// parts of the mesh in any order and on any number of threads. The list is sorted by key, so the
// CPU finds the neighbours of a brick by binary search. Host and device, except for what is marked
// as host only.
#pragma once

#include <cstdint>

#include "core/first_from.hpp"
#include "core/host_device.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/brick_geometry.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

// What counting found in a brick. Row (y, z) has the number 8 z + y.
struct ActiveBrick {
  std::uint64_t key;  // brick_key() of the brick
  // clipped_cells: cells that the surface crosses and that have a virtual node as a corner. Virtual
  // nodes are the layer of nodes around the grid; they count as outside (brick_geometry.hpp).
  std::uint32_t vertices, triangles, clipped_cells;
  // By row: how many vertices the brick has in the rows of nodes before it, and how many triangles
  // in the rows of cells before it. A vertex belongs to the row of the node at the lower end of its
  // edge, a triangle to the row of its cell.
  std::uint16_t row_vertices[kBrickSide * kBrickSide];
  std::uint16_t row_triangles[kBrickSide * kBrickSide];
  BrickSigns signs;
};

// How many vertices and triangles there are: in one brick, or in all bricks before one. Numbers
// begin with 0, so the latter are also the numbers of the brick's first vertex and first triangle.
struct BrickSums {
  std::uint64_t vertices, triangles;
};

struct BrickList {
  const ActiveBrick* bricks;  // by rising key
  // size + 1 sums: before[b], over bricks 0 .. b - 1, has the numbers of the first vertex and the
  // first triangle of brick b. If the list is a part of the mesh's bricks only, the sums begin with
  // the counts of all bricks before the part instead of 0.
  const BrickSums* before;
  std::uint64_t size;
};

// Index of the first brick whose key is at least `key`, or list.size: a binary search.
VDWMESH_HD inline std::uint64_t lower_bound_of_key(const BrickList& list, std::uint64_t key) {
  return first_from(std::uint64_t{0}, list.size,
                    [&](std::uint64_t i) { return list.bricks[i].key < key; });
}

// A brick and its 26 neighbours. The slot of the neighbour at an offset of -1, 0 or 1 along each
// axis is a base-3 number; slot 13 is the brick itself.
inline constexpr int kNeighbours = 27;
VDWMESH_HD constexpr int neighbour_slot(int dx, int dy, int dz) {
  return (dz + 1) * 9 + (dy + 1) * 3 + dx + 1;
}

// Throws InternalError; the message says that the surface leaves the brick for a neighbour that is
// not in the list. The function is defined in brick_mesher.cpp, because loops that are compiled for
// two processor generations (multiversion.hpp) get copies of everything inline that they call, and
// would get the formatting of the message twice. Host only.
[[noreturn]] void throw_missing_neighbour(const BrickIndex& brick);

// Index in the list of the neighbour at `slot` (neighbour_slot()) of the brick with that key.
// Precondition: of the nodes that cells of both bricks have, some are inside and some are
// outside. Then two of them at the ends of one lattice edge differ, and the surface crosses
// every cell at this edge, in the neighbour too. The brick search keeps every brick with
// surface, so the neighbour is in the list. Throws InternalError if it is not: using another
// brick instead would silently produce a wrong mesh. Host only; the device has a search of its
// own in triangle_neighbours.cu.
inline std::uint64_t find_neighbour(const BrickList& list, std::uint64_t key, int slot) {
  const BrickIndex own = brick_of_key(key);
  const BrickIndex b{own.x + slot % 3 - 1, own.y + slot / 3 % 3 - 1, own.z + slot / 9 - 1};
  const std::uint64_t place = lower_bound_of_key(list, brick_key(b));
  if (place == list.size || list.bricks[place].key != brick_key(b)) {
    throw_missing_neighbour(own);
  }
  return place;
}

// Names a node or a cell by the brick that owns it and by its coordinates in that brick.
struct OwnerPosition {
  std::uint64_t brick;  // index in the brick list
  int x, y, z;          // 0 .. 7
};

// Finds the owner of a node or cell that is given by coordinates -1 .. 8 relative to some brick.
// The owner's offset from that brick along x is `x >> 3`: -1, 0 or 1. neighbour(slot) must return
// the index in the list of the brick at that neighbour_slot().
template <class Neighbour>
VDWMESH_HD OwnerPosition locate(Neighbour&& neighbour, int x, int y, int z) {
  return {neighbour(neighbour_slot(x >> 3, y >> 3, z >> 3)), x & 7, y & 7, z & 7};
}

// The border cells of the row (y, z): bit x is set if cell x = 0 .. 7 has a virtual node as a
// corner. ActiveBrick::clipped_cells counts the border cells that the surface crosses. A cell's
// corners are nodes i and i + 1 along each axis, and bit i = 0 .. 8 of g.real[axis] is set if node
// i belongs to the grid. If nodes y and y + 1, or z and z + 1, do not both belong to it, all cells
// of the row are border cells.
VDWMESH_HD inline std::uint32_t border_cells(const BrickGeometry& g, int y, int z) {
  const bool border_row = ((g.real[1] >> y) & 3) != 3 || ((g.real[2] >> z) & 3) != 3;
  const std::uint32_t all_cells = (1u << kBrickSide) - 1, real_x = g.real[0];
  return border_row ? all_cells : ~(real_x & (real_x >> 1)) & all_cells;
}

}  // namespace vdwmesh
