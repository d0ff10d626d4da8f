// The neighbours of each brick in the list of bricks, by which triangles name vertices and
// half-edges of other bricks.
#pragma once

#include <cstdint>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// The keys of bricks or lattice blocks: the first `count` entries of the array, which may be
// longer.
struct KeyList {
  DeviceArray<std::uint64_t> keys;
  std::uint64_t count = 0;
};

// The neighbours that the triangles of a brick touch, as indices into the list of bricks; kNoBrick
// if a neighbour is not in the list. Entry dx + 2 dy + 4 dz - 1 is the upper neighbour at offset
// (dx, dy, dz), each 0 or 1 and not all 0: seven of them. Entry 7 + axis is the neighbour across
// the lower face of an axis.
inline constexpr int kTriangleNeighbours = 10;
inline constexpr std::uint32_t kNoBrick = ~std::uint32_t{0};
struct TriangleNeighbours {
  std::uint32_t place[kTriangleNeighbours];
};

// Index into TriangleNeighbours::place of the neighbour at an offset of 0 or 1 along each axis; -1
// if all are 0, which means the brick itself.
__host__ __device__ constexpr int upper_neighbour(int dx, int dy, int dz) {
  return dx + 2 * dy + 4 * dz - 1;
}

// Index into TriangleNeighbours::place of the neighbour across a face: 7 + axis for a lower face,
// and upper_neighbour() with the offset along the axis for an upper one.
__host__ __device__ constexpr int neighbour_across(int face) {
  return face % 2 == 0 ? 7 + face / 2 : (1 << face / 2) - 1;
}

// Writes the neighbours of each of the bricks with these keys. Throws
// LimitExceeded if 32 bits do not suffice to number the bricks.
void find_triangle_neighbours(const KeyList& keys, TriangleNeighbours* neighbours,
                              const Stream& stream);

}  // namespace vdwmesh
