// The regular grid that marching cubes walks, and its division into bricks.
#pragma once

#include <cstdint>
#include <optional>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The box to which the padding is added: around the balls, or around their centres only.
enum class GridBox { balls, centers };

// How the number of cells is rounded: the cells cover the padded box and may reach beyond it
// (cover), or end inside the padded box (floor).
enum class GridRounding { cover, floor };

// A regular grid. Node (i, j, k) lies at origin + spacing * (i, j, k); i runs from 0 to cells.x,
// j to cells.y and k to cells.z.
struct GridSpec {
  Vec3d origin;    // Å
  double spacing;  // Å
  Vec3i cells;     // number of cells along x, y and z

  std::uint64_t cell_count() const;
  std::uint64_t node_count() const;
};

// Largest number of cells along an axis. A grid then has fewer than 2^60 nodes, its virtual border
// included, so that a grid edge, 3 * node + axis, can be numbered in 64 bits.
inline constexpr std::int64_t kMaxCellsPerAxis = (std::int64_t{1} << 20) - 4;

// Throws InvalidInput unless origin and spacing are finite, the spacing is above 0, and there are 0
// or more cells along each axis. Throws LimitExceeded for more than kMaxCellsPerAxis cells along an
// axis, and if the spacing is finer than doubles resolve at the grid's place.
void check(const GridSpec& grid);

struct GridOptions {
  double spacing = 0.5;           // Å
  std::optional<double> padding;  // width added to the box on all sides, Å; unset: 3 spacings
  GridBox box = GridBox::balls;
  GridRounding rounding = GridRounding::cover;
  // If set, this grid is used wherever the spheres are, and the options above are ignored. So all
  // frames of a trajectory can have the same nodes, and parts of a molecule the grid of the whole.
  // Surface that leaves the grid is closed at the grid's border; ExtractStats::grid_clipped counts
  // the cells in which it is.
  std::optional<GridSpec> given{};
};

// Makes a grid around the spheres, or checks and returns options.given. The origin is the lower
// corner of the box less the padding. It is not rounded to multiples of the spacing, so if all
// spheres are translated, the grid moves with them. Throws InvalidInput if there are no spheres, if
// the spacing is not finite and above 0, or if the padding is not finite and at least 0. Throws
// LimitExceeded as check() does.
GridSpec make_grid(const SphereSet& spheres, const GridOptions& options);
// The same for spheres of which only the boxes around the balls and around their centres are known.
GridSpec make_grid(const Box& balls, const Box& centers, const GridOptions& options);

// Coordinate of node `index` along an axis. It is rounded once, by the fused multiply-add, so every
// backend gets the same bits.
VDWMESH_HD inline double node_coordinate(double origin, double spacing, std::int64_t index) {
  using std::fma;
  return fma(static_cast<double>(index), spacing, origin);
}

// Bricks divide the work. A brick owns kBrickSide^3 nodes, the cells whose lower corner is one of
// these nodes, and the grid edges that leave one of them along +x, +y or +z. The side is 8 because
// 8 rows of 8 nodes are one 64-bit mask, or two warps of a GPU, and because the field of a brick
// fits in the GPU's shared memory.
//
// A virtual layer of nodes surrounds the grid. Its nodes are outside by definition, so that every
// mesh is closed. Bricks count nodes from this layer on: along an axis, grid node i has the lattice
// index i + 1, and the virtual nodes have the lattice indices 0 and cells + 2.
inline constexpr int kBrickSide = 8;
inline constexpr int kBrickNodes = kBrickSide * kBrickSide * kBrickSide;

// A brick by its index along each axis: it owns the lattice indices 8 x .. 8 x + 7 along x, and so
// on.
struct BrickIndex {
  std::int32_t x, y, z;
  friend constexpr bool operator==(const BrickIndex&, const BrickIndex&) = default;
};

// A number for a brick, 21 bits for each index. Rising keys order bricks with x fastest and z
// slowest.
VDWMESH_HD constexpr std::uint64_t brick_key(const BrickIndex& b) {
  return (static_cast<std::uint64_t>(b.z) << 42) | (static_cast<std::uint64_t>(b.y) << 21) |
         static_cast<std::uint64_t>(b.x);
}

// A key that no brick has; it is above the key of every brick.
inline constexpr std::uint64_t kNoBrickKey = ~std::uint64_t{0};

// The bricks with begin <= key < end. The default is all bricks.
struct KeyRange {
  std::uint64_t begin = 0;
  std::uint64_t end = kNoBrickKey;
};

VDWMESH_HD constexpr BrickIndex brick_of_key(std::uint64_t key) {
  constexpr std::uint64_t mask = (std::uint64_t{1} << 21) - 1;
  return {static_cast<std::int32_t>(key & mask), static_cast<std::int32_t>((key >> 21) & mask),
          static_cast<std::int32_t>(key >> 42)};
}

}  // namespace vdwmesh
