// Builds the grid in passes over all triangles: the extent and the mean width of their boxes, then
// the number of entries per cell, a prefix sum, and the entries. Each pass computes the boxes anew,
// which saves the memory that they would take.
#include "refine/triangle_grid.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/blocks.hpp"

namespace vdwmesh {
namespace {

// The width of a cell, in units of the mean width of a triangle's box. With 1 a triangle has about
// three entries, and a cell that the surface crosses has about ten.
constexpr double kCellWidth = 1;

struct Extent {
  Box all = empty_box();  // holds the boxes of all triangles
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
  // The sum of widths is rounded, and depends on how the range is cut. The deterministic reduction
  // cuts it alike on every run, for any number of threads.
  return tbb::parallel_deterministic_reduce(
      patches, Extent{},
      [&](const auto& range, Extent total) {
        for (std::size_t patch = range.begin(); patch != range.end(); ++patch) {
          const auto v = level.vertices(patch);
          for (int child = 0; child < Level::kTriangles; ++child) {
            const Box box = bounds_of(level, v, child);
            total = join(total, {box, width(box)});
          }
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

// The index, along one axis, of the cell that holds the coordinate. Every coordinate lies within
// the box of all triangles, and the clamping only catches rounding at its ends. Rounding keeps the
// order of coordinates, so a point of a box never falls in a cell before or behind the cells of the
// box.
std::uint32_t TriangleGrid::cell_along(int axis, double coordinate) const {
  const double place = std::max(in_cells(origin_[axis], coordinate, cell_), 0.0);
  return std::min(static_cast<std::uint32_t>(place), cells_[static_cast<std::size_t>(axis)] - 1);
}

// Sets the origin and the width of the cells, and returns the box of all triangles. The width
// starts at the mean width of a triangle and grows until the grid has few enough cells. The loop
// ends, since the width grows by 1 % at least in each turn, and a grid with cells wider than the
// box has one cell.
template <class Level>
Box TriangleGrid::choose_cells(const Level& level) {
  const double triangles = static_cast<double>(level.patches() * Level::kTriangles);
  const Extent extent = extent_of(level);
  origin_ = extent.all.lower;
  // The lower bound avoids a division by zero if every triangle is a point.
  cell_ = std::max(kCellWidth * extent.width_sum / triangles, 1e-100);
  const double most = std::max(64.0, 2 * triangles);
  constexpr double kWiden = 1e30;  // growth while the number of cells overflows a double
  for (double total; !((total = cells_in(extent.all, cell_)) <= most);) {
    cell_ *= std::isfinite(total) ? std::max(1.01, std::cbrt(total / most)) : kWiden;
  }
  return extent.all;
}

void TriangleGrid::set_cells(const Box& all) {
  for (int axis = 0; axis < 3; ++axis) {
    cells_[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(cells_along(all, cell_, axis));
  }
}

// Calls visit(triangle, cell) for every entry, from many threads at once.
template <class Level, class Visit>
void TriangleGrid::visit_all(const Level& level, const Visit& visit) const {
  for_all(level.patches(), [&](std::size_t patch) {
    const auto v = level.vertices(patch);
    for (int child = 0; child < Level::kTriangles; ++child) {
      const std::size_t t = Level::kTriangles * patch + static_cast<std::size_t>(child);
      visit_cells(bounds_of(level, v, child),
                  [&](std::size_t cell) { visit(static_cast<std::uint32_t>(t), cell); });
    }
  });
}

// Writes the number of entries of each cell to start_, and returns their sum. The sum has 64 bits,
// because it may exceed what offsets of 32 bits can hold.
template <class Level>
std::uint64_t TriangleGrid::count_entries(const Level& level) {
  start_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2] + 1, 0);
  visit_all(level, [&](std::uint32_t, std::size_t cell) {
    std::atomic_ref(start_[cell]).fetch_add(1, std::memory_order_relaxed);
  });
  return std::accumulate(start_.begin(), start_.end(), std::uint64_t{0});
}

template <class Level>
TriangleGrid::TriangleGrid(const Level& level, std::uint64_t most_entries) {
  const Box all = level.patches() > 0 ? choose_cells(level) : Box{};
  set_cells(all);
  // Cells of twice the width have fewer entries; one cell has one entry per triangle.
  while (count_entries(level) > most_entries && start_.size() > 2) {
    cell_ *= 2;
    set_cells(all);
  }
  std::inclusive_scan(start_.begin(), start_.end(), start_.begin());
  triangles_.resize(start_.back());
  // After the prefix sum start_[c] is the end of cell c. Each cell is filled from its end, so
  // start_[c] arrives at the cell's first entry.
  visit_all(level, [&](std::uint32_t t, std::size_t cell) {
    triangles_[std::atomic_ref(start_[cell]).fetch_sub(1, std::memory_order_relaxed) - 1] = t;
  });
}

template TriangleGrid::TriangleGrid(const Given&, std::uint64_t);
template TriangleGrid::TriangleGrid(const Midpoints&, std::uint64_t);

}  // namespace vdwmesh
