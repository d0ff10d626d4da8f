// How the levels of a cell list follow from its spheres: which level takes a sphere, and which
// cells a level has. Host and device build their lists by these functions, so both have the same.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/host_device.hpp"
#include "spheres/box.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// The level of a sphere: the octave of its reach above the smallest reach; the last level takes all
// larger reaches. With a given frame, a reach may be below the frame's smallest one: then the level
// is 0. A ratio that rounding has put just below a power of two counts as that power, for which it
// is widened by 1e-12. ilogb() reads the exponent of a double, so it is exact on host and device.
VDWMESH_HD inline int level_of(double reach, double smallest) {
  const int octave = std::ilogb(reach / smallest * (1 + 1e-12));
  constexpr int last = CellListView::kMaxLevels - 1;
  return octave < 0 ? 0 : octave < last ? octave : last;
}

// What the spheres of one level have in common.
struct LevelExtent {
  std::size_t spheres = 0;
  Box centers = empty_box();  // around their centres, Å
  double reach = 0;           // the largest, Å

  void add(const Vec3d& center, double sphere_reach) {
    include(centers, center);
    reach = std::max(reach, sphere_reach);
    ++spheres;
  }
  void add(const LevelExtent& other) {
    include(centers, other.centers);
    reach = std::max(reach, other.reach);
    spheres += other.spheres;
  }
};

// By level of a frame.
using LevelExtents = std::array<LevelExtent, CellListView::kMaxLevels>;

inline void add(LevelExtents& all, const LevelExtents& part) {
  for (std::size_t level = 0; level < all.size(); ++level) all[level].add(part[level]);
}

// The least of the reaches, infinite if there are none.
double least_of(std::span<const double> reach);

// The extents of the levels of a frame with this smallest reach. `reach[i]` is the reach of sphere
// i, Å.
LevelExtents level_extents(const SphereSet& spheres, std::span<const double> reach,
                           double smallest_reach);

// The frame whose levels have these extents, beginning with level 0; at most kMaxLevels of them, of
// which one has spheres.
CellListFrame frame_of(std::span<const LevelExtent> extents, double smallest_reach);

// Number of the cell of a level in which a centre lies, x fastest, below kMostBins. Precondition:
// the centre is within the cells of the level.
VDWMESH_HD inline std::uint32_t cell_index(const CellLevel& level, const Vec3d& center) {
  const std::int32_t x = cell_along(level, 0, center.x);
  const std::int32_t y = cell_along(level, 1, center.y);
  const std::int32_t z = cell_along(level, 2, center.z);
  const std::int64_t row = std::int64_t{z} * level.cells[1] + y;
  return static_cast<std::uint32_t>(row * level.cells[0] + x);
}

inline std::size_t cell_count(const CellLevel& level) {
  return static_cast<std::size_t>(level.cells[0]) * static_cast<std::size_t>(level.cells[1]) *
         static_cast<std::size_t>(level.cells[2]);
}

}  // namespace vdwmesh
