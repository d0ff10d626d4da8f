// Positions of the nodes of one brick, and which of these nodes belong to the grid. A brick at the
// border of the grid also holds nodes of the virtual layer and nodes beyond it; all of them count
// as outside, which closes the mesh there. Host and device.
#pragma once

#include "core/host_device.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {

// Nodes have local numbers 0 .. 8 along each axis; node 8 is the first node of the next brick. Node
// i along an axis has the lattice index 8 * brick + i (lattice_index()).
struct BrickGeometry {
  BrickIndex brick;
  double coordinate[3][kBrickReach];  // Å, of nodes 0 .. 8 along each axis
  std::uint16_t real[3];              // bit i: node i along that axis belongs to the grid

  // Position of a node, Å.
  VDWMESH_HD Vec3d node(int x, int y, int z) const {
    return {coordinate[0][x], coordinate[1][y], coordinate[2][z]};
  }
  VDWMESH_HD bool has_virtual_nodes() const {
    return (real[0] & real[1] & real[2]) != (1u << kBrickReach) - 1;
  }
};

VDWMESH_HD inline BrickGeometry brick_geometry(const GridSpec& grid, const BrickIndex& brick) {
  BrickGeometry g{};
  g.brick = brick;
  const std::int32_t index[3] = {brick.x, brick.y, brick.z};
  for (int axis = 0; axis < 3; ++axis) {
    std::uint32_t real = 0;
    for (int i = 0; i < kBrickReach; ++i) {
      const std::int64_t lattice = lattice_index(index[axis], i);
      g.coordinate[axis][i] = lattice_coordinate(grid, axis, lattice);
      if (!is_virtual(grid, axis, lattice)) real |= 1u << i;
    }
    g.real[axis] = static_cast<std::uint16_t>(real);
  }
  return g;
}

// Clears the signs of the virtual nodes. They are outside whatever the field's value is there.
VDWMESH_HD inline void clear_virtual_nodes(const BrickGeometry& g, BrickSigns& signs) {
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      const bool real_row = (g.real[1] >> y & g.real[2] >> z & 1) != 0;
      signs.row[z][y] =
          real_row ? static_cast<std::uint16_t>(signs.row[z][y] & g.real[0]) : std::uint16_t{0};
    }
  }
}

}  // namespace vdwmesh
