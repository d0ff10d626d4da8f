// The regular grid that marching cubes walks, and its division into bricks.
#pragma once

#include <cstdint>
#include <optional>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// What the padding is measured from.
enum class GridBox { balls, centers };

// Whether the last cell may reach beyond the padded box (cover) or must end inside it (floor).
enum class GridRounding { cover, floor };

// Node (i, j, k), 0 <= i <= cells.x and so on, lies at origin + spacing * (i, j, k).
struct GridSpec {
  Vec3d origin;    // Å
  double spacing;  // Å
  Vec3i cells;     // along x, y and z

  std::uint64_t cell_count() const;
  std::uint64_t node_count() const;
};

// Longest side of a grid, so that 3 * node + axis fits in 64 bits with room for the border.
inline constexpr std::int64_t kMaxCellsPerAxis = (std::int64_t{1} << 20) - 4;

// Throws InvalidInput unless origin and spacing are finite, the spacing above 0, and the cells
// along each axis 0 or more; LimitExceeded beyond kMaxCellsPerAxis.
void check(const GridSpec& grid);

struct GridOptions {
  double spacing = 0.5;           // Å
  std::optional<double> padding;  // Å; unset: 3 spacings
  GridBox box = GridBox::balls;
  GridRounding rounding = GridRounding::cover;
  // The grid itself, wherever the spheres are; the options above do not count then. The frames of a
  // trajectory keep their nodes so, and a part of a molecule gets the whole's. Surface that leaves
  // the grid is closed at its border, and counted (ExtractStats::grid_clipped).
  std::optional<GridSpec> given{};
};

// The origin is the lower corner of the box less the padding, not rounded, so a translated set
// gets the same grid. Throws InvalidInput for no spheres, spacing not finite and positive, or
// padding not finite and >= 0; LimitExceeded beyond kMaxCellsPerAxis. A given grid is checked and
// returned as it is.
GridSpec make_grid(const SphereSet& spheres, const GridOptions& options);

// Coordinate of node `index` along an axis; one rounding, the same on every backend.
VDWMESH_HD inline double node_coordinate(double origin, double spacing, std::int64_t index) {
  using std::fma;
  return fma(static_cast<double>(index), spacing, origin);
}

// Bricks. A brick owns kBrickSide^3 nodes, the cells whose lower corner is one of them and the
// grid edges that leave one of them along +x, +y, +z. 8 rows of 8 nodes are one 64-bit mask or two
// warps, and the field of a brick fits in shared memory.
//
// Nodes are numbered from the virtual layer that surrounds the grid: lattice index = node + 1, and
// indices 0 and cells + 2 are the virtual nodes, outside by definition, so that every mesh closes.
inline constexpr int kBrickSide = 8;
inline constexpr int kBrickNodes = kBrickSide * kBrickSide * kBrickSide;

struct BrickIndex {
  std::int32_t x, y, z;
  friend constexpr bool operator==(const BrickIndex&, const BrickIndex&) = default;
};

// Orders bricks z-y-x: z slowest, x fastest.
VDWMESH_HD constexpr std::uint64_t brick_key(const BrickIndex& b) {
  return (static_cast<std::uint64_t>(b.z) << 42) | (static_cast<std::uint64_t>(b.y) << 21) |
         static_cast<std::uint64_t>(b.x);
}

// Above the key of every brick.
inline constexpr std::uint64_t kNoBrickKey = ~std::uint64_t{0};

// The bricks whose key is from `begin` on and below `end`.
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
