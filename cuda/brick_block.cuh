// What blocks of threads that work on one brick share.
#pragma once

#include "extract/brick_geometry.hpp"
#include "extract/brick_numbering.hpp"

namespace vdwmesh {

inline constexpr unsigned kBrickThreads = 128;
inline constexpr int kRows = kBrickReach * kBrickReach;   // rows of nodes that cells touch
inline constexpr int kOwnRows = kBrickSide * kBrickSide;  // rows of own nodes, and of cells

// brick_geometry() by the threads of a block.
__device__ inline void share_geometry(const GridSpec& grid, std::uint64_t key, BrickGeometry& g) {
  const BrickIndex brick = brick_of_key(key);
  const int i = static_cast<int>(threadIdx.x) % kBrickReach;
  const int axis = static_cast<int>(threadIdx.x) / kBrickReach;
  if (threadIdx.x == 0) g.brick = brick;
  if (axis < 3) {
    const std::int32_t index = axis == 0 ? brick.x : (axis == 1 ? brick.y : brick.z);
    g.coordinate[axis][i] = lattice_coordinate(grid, axis, lattice_index(index, i));
    if (i == 0) {
      std::uint32_t real = 0;
      for (int n = 0; n < kBrickReach; ++n) {
        if (!is_virtual(grid, axis, lattice_index(index, n))) real |= 1u << n;
      }
      g.real[axis] = static_cast<std::uint16_t>(real);
    }
  }
  __syncthreads();
}

// Copies a brick between global and shared memory; the caller synchronises.
__device__ inline void copy_brick(const ActiveBrick* from, ActiveBrick* to) {
  static_assert(sizeof(ActiveBrick) % sizeof(std::uint64_t) == 0);
  const auto* source = reinterpret_cast<const std::uint64_t*>(from);
  auto* target = reinterpret_cast<std::uint64_t*>(to);
  for (unsigned w = threadIdx.x; w < sizeof(ActiveBrick) / sizeof(std::uint64_t);
       w += kBrickThreads) {
    target[w] = source[w];
  }
}

}  // namespace vdwmesh
