// Builds the grid in passes over all patches. An entry is one patch in the list of one cell. The
// first pass finds the extent and the mean width of the patches' boxes, which give the cells. The
// second writes the boxes in units of a cell, as floats. The third counts the entries per cell; it
// is repeated with wider cells if there are too many. After a prefix sum, the last pass writes the
// entries.
#include "refine/patch_grid.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/blocks.hpp"

namespace vdwmesh {
namespace {

// The width of a cell at first, in units of the mean width of a patch's box. Wider cells make fewer
// entries and more pairs of patches that are far apart; from 2 to 3.5 the time is about the same.
constexpr double kCellWidth = 2.5;

struct Extent {
  Box all = empty_box();  // holds the boxes of all patches
  double width_sum = 0;   // the sum of their widths, Å
};

Extent join(Extent a, const Extent& b) {
  include(a.all, b.all);
  a.width_sum += b.width_sum;
  return a;
}

// The longest side of the box.
double width(const Box& box) {
  return std::max(
      {box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z});
}

template <class Level>
Extent extent_of(const Level& level) {
  const tbb::blocked_range<std::size_t> patches(0, level.patches(), kBlock);
  // The sum of widths is rounded, so it depends on the order of the additions. The deterministic
  // reduction cuts the range alike on every run, for any number of threads, and keeps that order.
  return tbb::parallel_deterministic_reduce(
      patches, Extent{},
      [&](const auto& range, Extent total) {
        for (std::size_t patch = range.begin(); patch != range.end(); ++patch) {
          const Box box = bounds_of(level, level.vertices(patch));
          total = join(total, {box, width(box)});
        }
        return total;
      },
      join);
}

// (upper - lower) / cell. The difference of two large doubles may overflow; the difference of their
// halves cannot. Halving is exact, so it does not change the result otherwise.
double in_cells(double lower, double upper, double cell) {
  return (0.5 * upper - 0.5 * lower) / (0.5 * cell);
}

double cells_along(const Box& all, double cell, int axis) {
  return std::floor(in_cells(all.lower[axis], all.upper[axis], cell)) + 1;
}

double cells_in(const Box& all, double cell) {
  return cells_along(all, cell, 0) * cells_along(all, cell, 1) * cells_along(all, cell, 2);
}

}  // namespace

// Sets the origin and the width of the cells, and returns the box of all patches. The width starts
// at kCellWidth times the mean width of a patch's box and grows until the grid has at most two
// cells per patch, or 64. The loop ends, since the width grows by 1 % at least in each turn, and a
// grid with cells wider than the box of all patches has one cell.
template <class Level>
Box PatchGrid::choose_cells(const Level& level) {
  const double patches = static_cast<double>(level.patches());
  const Extent extent = extent_of(level);
  origin_ = extent.all.lower;
  // The lower bound avoids a division by zero if every patch is a point.
  cell_ = std::max(kCellWidth * extent.width_sum / patches, 1e-100);
  const double most = std::max(64.0, 2 * patches);
  constexpr double kWiden = 1e30;  // growth while the number of cells overflows a double
  // The condition computes `total`; written with !, it goes on if that is infinite or NaN. To bring
  // the number of cells down to `most`, the width grows by the cube root of the excess.
  for (double total; !((total = cells_in(extent.all, cell_)) <= most);) {
    cell_ *= std::isfinite(total) ? std::max(1.01, std::cbrt(total / most)) : kWiden;
  }
  return extent.all;
}

void PatchGrid::set_cells(const Box& all) {
  for (int axis = 0; axis < 3; ++axis) {
    cells_[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(cells_along(all, cell_ / scale_, axis));
  }
}

// Writes the boxes of all patches. Every step from a coordinate to the float keeps the order of
// coordinates, rounding included.
template <class Level>
void PatchGrid::find_boxes(const Level& level) {
  const double per_half_cell = 1 / (0.5 * cell_);
  boxes_.resize(level.patches());
  for_all(level.patches(), [&](std::size_t patch) {
    const Box box = bounds_of(level, level.vertices(patch));
    for (int axis = 0; axis < 3; ++axis) {
      const auto in_cells_of_grid = [&](double x) {
        return static_cast<float>((0.5 * x - 0.5 * origin_[axis]) * per_half_cell);
      };
      const auto i = static_cast<std::size_t>(axis);
      boxes_[patch].lower[i] = in_cells_of_grid(box.lower[axis]);
      boxes_[patch].upper[i] = in_cells_of_grid(box.upper[axis]);
    }
  });
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
  const Box all = level.patches() > 0 ? choose_cells(level) : Box{};
  set_cells(all);
  find_boxes(level);
  // With cells twice as wide there are fewer entries. A size of 2 means a single cell, in which
  // each patch has one entry.
  while (count_entries() > most_entries && start_.size() > 2) {
    scale_ *= 0.5;
    set_cells(all);
  }
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
