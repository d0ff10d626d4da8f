// Builds the grid in passes over all patches. An entry is one patch in the list of one cell. The
// first pass writes the boxes, and finds their extent and mean width, which give the cells. The
// second counts the entries per cell; it is repeated with wider cells if there are too many. After
// a prefix sum, the last pass writes the entries.
#include "refine/crossings/patch_grid.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/blocks.hpp"
#include "core/lanes/lanes.hpp"

namespace vdwmesh {
namespace {

// The width of a cell at first, in units of the mean width of a patch's box. Wider cells make fewer
// entries and more pairs of patches that are far apart; from 2 to 3.5 the time is about the same.
constexpr double kCellWidth = 2.5;

// x, y and z in single precision, and any number.
using FloatPoint = float __attribute__((vector_size(4 * sizeof(float))));

struct FloatBounds {
  FloatPoint lower, upper;
};

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr FloatPoint kAllFar{kFar, kFar, kFar, kFar};

VDWMESH_INLINE FloatPoint lesser(const FloatPoint& a, const FloatPoint& b) { return a < b ? a : b; }
VDWMESH_INLINE FloatPoint greater(const FloatPoint& a, const FloatPoint& b) {
  return a > b ? a : b;
}

VDWMESH_INLINE void include(FloatBounds& bounds, const FloatBounds& other) {
  bounds.lower = lesser(bounds.lower, other.lower);
  bounds.upper = greater(bounds.upper, other.upper);
}

// The place of a point relative to the origin. Every step keeps the order of coordinates, rounding
// included.
VDWMESH_INLINE FloatPoint relative(const Vec3d& p, const Vec3d& origin) {
  const Lanes from{p.x - origin.x, p.y - origin.y, p.z - origin.z, 0};
  return __builtin_convertvector(from, FloatPoint);
}

VDWMESH_INLINE PatchBox box_of(const FloatBounds& bounds) {
  return {{bounds.lower[0], bounds.lower[1], bounds.lower[2]},
          {bounds.upper[0], bounds.upper[1], bounds.upper[2]}};
}

// The longest side of the box.
VDWMESH_INLINE float width_of(const FloatBounds& bounds) {
  const FloatPoint sides = bounds.upper - bounds.lower;
  return std::max({sides[0], sides[1], sides[2]});
}

}  // namespace

struct PatchGrid::Extent {
  FloatBounds all{kAllFar, -kAllFar};  // holds the boxes of all patches
  double width_sum = 0;                // the sum of their widths, Å
};

// Writes the boxes of all patches and of their parts. The sum of widths is rounded, so it depends
// on the order of the additions. The deterministic reduction cuts the range alike on every run, for
// any number of threads, and keeps that order.
template <class Level>
PatchGrid::Extent PatchGrid::find_boxes(const Level& level) {
  constexpr auto kVertices = static_cast<std::size_t>(Level::kVertices);
  const Buffer<Vec3d>& positions = level.mesh.positions;
  const Vec3d origin = positions[level.vertices(0)[0]];
  boxes_.resize(level.patches());
  if constexpr (Level::kParts > 1) part_boxes_.resize(level.patches());
  const auto measure = [&](std::size_t patch, Extent& total) {
    const auto v = level.vertices(patch);
    FloatBounds bounds{kAllFar, -kAllFar};
    FloatPoint place[kVertices];
    for (std::size_t i = 0; i < kVertices; ++i) {
      place[i] = relative(positions[v[i]], origin);
      include(bounds, {place[i], place[i]});
      if constexpr (!Level::kStartsBetweenCorners) {
        const FloatPoint start = relative(level.before(v, i), origin);
        include(bounds, {start, start});
      }
    }
    if constexpr (Level::kParts > 1) {
      for (std::size_t part = 0; part < Level::kParts; ++part) {
        FloatBounds of_part{kAllFar, -kAllFar};
        for (const int i : Level::vertices_of_part(static_cast<int>(part))) {
          include(of_part, {place[i], place[i]});
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
          part_boxes_[patch].lower[axis][part] = of_part.lower[axis];
          part_boxes_[patch].upper[axis][part] = of_part.upper[axis];
        }
      }
    }
    boxes_[patch] = box_of(bounds);
    include(total.all, bounds);
    total.width_sum += static_cast<double>(width_of(bounds));
  };
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, level.patches(), kBlock), Extent{},
      [&](const auto& range, Extent total) {
        run_block(range.begin(), range.end(), measure, total);
        return total;
      },
      [](Extent a, const Extent& b) {
        include(a.all, b.all);
        a.width_sum += b.width_sum;
        return a;
      });
}

// Sets the place and the width of the cells. The width starts at kCellWidth times the mean width of
// a patch's box and grows until the grid has at most two cells per patch, or 64. The loop ends,
// since the width grows by 1 % at least in each turn, and a grid with cells wider than the box of
// all patches has one cell. Ends of that box that are infinite in single precision are moved to the
// largest float, so that its sides are finite; cell_along() puts what lies beyond into the first or
// the last cell. Only meshes larger than check_mesh() lets through have such ends.
void PatchGrid::choose_cells(const Extent& extent) {
  constexpr double kMost = std::numeric_limits<float>::max();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower_[axis] = std::max(static_cast<double>(extent.all.lower[axis]), -kMost);
    sides_[axis] = std::min(static_cast<double>(extent.all.upper[axis]), kMost) - lower_[axis];
  }
  const double patches = static_cast<double>(boxes_.size());
  // The lower bound avoids a division by zero if every patch is a point. If single precision cannot
  // tell the widths, there is one cell.
  double width = std::numeric_limits<double>::infinity();
  if (std::isfinite(extent.width_sum)) {
    width = std::max(kCellWidth * extent.width_sum / patches, 1e-100);
  }
  const double most = std::max(64.0, 2 * patches);
  constexpr double kWiden = 1e30;  // growth while the number of cells overflows a double
  // To bring the number of cells down to `most`, the width grows by the cube root of the excess.
  for (double total; (total = cells_in(width)) > most;) {
    width *= std::isfinite(total) ? std::max(1.01, std::cbrt(total / most)) : kWiden;
  }
  set_cells(width);
}

double PatchGrid::cells_along(std::size_t axis, double width) const {
  return std::floor(sides_[axis] / width) + 1;
}

double PatchGrid::cells_in(double width) const {
  return cells_along(0, width) * cells_along(1, width) * cells_along(2, width);
}

void PatchGrid::set_cells(double width) {
  cell_ = width;
  per_cell_ = 1 / width;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cells_[axis] = static_cast<std::uint32_t>(cells_along(axis, width));
  }
}

// Calls visit(patch, cell) for every entry, from many threads at once.
template <class Visit>
void PatchGrid::visit_all(const Visit& visit) const {
  for_all(boxes_.size(), [&](std::size_t patch) {
    visit_cells(patch, [&](std::size_t cell) { visit(static_cast<std::uint32_t>(patch), cell); });
  });
}

// Writes the number of entries of each cell to start_ and returns the sum. The sum has 64 bits,
// because it may exceed what offsets of 32 bits can hold. A single count cannot: it is at most the
// number of patches.
std::uint64_t PatchGrid::count_entries() {
  start_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2] + 1, 0);
  visit_all([&](std::uint32_t, std::size_t cell) {
    std::atomic_ref(start_[cell]).fetch_add(1, std::memory_order_relaxed);
  });
  return std::accumulate(start_.begin(), start_.end(), std::uint64_t{0});
}

template <class Level>
PatchGrid::PatchGrid(const Level& level, std::uint64_t most_entries) {
  if (level.patches() > 0) choose_cells(find_boxes(level));
  // With cells twice as wide there are fewer entries. A size of 2 means a single cell, in which
  // each patch has one entry.
  while (count_entries() > most_entries && start_.size() > 2) set_cells(2 * cell_);
  std::inclusive_scan(start_.begin(), start_.end(), start_.begin());
  patches_.resize(start_.back());
  // After the prefix sum start_[c] is the end of the list of cell c. Each list is filled from its
  // end backwards, which moves start_[c] to its first entry.
  visit_all([&](std::uint32_t patch, std::size_t cell) {
    patches_[std::atomic_ref(start_[cell]).fetch_sub(1, std::memory_order_relaxed) - 1] = patch;
  });
}

template PatchGrid::PatchGrid(const Given&, std::uint64_t);
template PatchGrid::PatchGrid(const Midpoints&, std::uint64_t);
template PatchGrid::PatchGrid(const DividedMidpoints&, std::uint64_t);

}  // namespace vdwmesh
