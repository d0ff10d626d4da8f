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

// In units of the mean width of a triangle's bounds: a triangle stands in about three cells, and a
// cell holds about ten.
constexpr double kCellWidth = 1;

struct Extent {
  Bounds all = no_bounds();
  double width_sum = 0;
};

Extent join(Extent a, const Extent& b) {
  for (int axis = 0; axis < 3; ++axis) {
    a.all.lower[axis] = std::min(a.all.lower[axis], b.all.lower[axis]);
    a.all.upper[axis] = std::max(a.all.upper[axis], b.all.upper[axis]);
  }
  a.width_sum += b.width_sum;
  return a;
}

double width(const Bounds& box) {
  return std::max(
      {box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z});
}

template <class Level>
Extent extent_of(const Level& level) {
  const tbb::blocked_range<std::size_t> patches(0, level.patches(), kBlock);
  // The sum is not exact, so the blocks must be the same on every run.
  return tbb::parallel_deterministic_reduce(
      patches, Extent{},
      [&](const auto& range, Extent total) {
        for (std::size_t patch = range.begin(); patch != range.end(); ++patch) {
          const auto v = level.vertices(patch);
          for (int child = 0; child < Level::kTriangles; ++child) {
            const Bounds box = bounds_of(level, v, child);
            total = join(total, {box, width(box)});
          }
        }
        return total;
      },
      join);
}

// From `lower` to `upper` in cells. Halves, because the whole way may overflow; being exact, they
// change nothing else.
double in_cells(double lower, double upper, double cell) {
  return (0.5 * upper - 0.5 * lower) / (0.5 * cell);
}

double cells_along(const Bounds& all, double cell, int axis) {
  return std::floor(in_cells(all.lower[axis], all.upper[axis], cell)) + 1;
}

double cells_in(const Bounds& all, double cell) {
  return cells_along(all, cell, 0) * cells_along(all, cell, 1) * cells_along(all, cell, 2);
}

}  // namespace

Bounds no_bounds() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

std::uint32_t TriangleGrid::cell_along(int axis, double coordinate) const {
  const double place = std::max(in_cells(origin_[axis], coordinate, cell_), 0.0);
  return std::min(static_cast<std::uint32_t>(place), cells_[static_cast<std::size_t>(axis)] - 1);
}

template <class Level>
Bounds TriangleGrid::choose_cells(const Level& level) {
  const double triangles = static_cast<double>(level.patches() * Level::kTriangles);
  const Extent extent = extent_of(level);
  origin_ = extent.all.lower;
  cell_ = std::max(kCellWidth * extent.width_sum / triangles, 1e-100);
  const double most = std::max(64.0, 2 * triangles);
  constexpr double kWiden = 1e30;  // where the number of cells overflows
  for (double total; !((total = cells_in(extent.all, cell_)) <= most);) {
    cell_ *= std::isfinite(total) ? std::max(1.01, std::cbrt(total / most)) : kWiden;
  }
  return extent.all;
}

void TriangleGrid::set_cells(const Bounds& all) {
  for (int axis = 0; axis < 3; ++axis) {
    cells_[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(cells_along(all, cell_, axis));
  }
}

// visit(triangle, cell) for each cell of each triangle, from many threads.
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

// Leaves in `start_` how many triangles stand in each cell.
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
  const Bounds all = level.patches() > 0 ? choose_cells(level) : Bounds{};
  set_cells(all);
  // In one cell all triangles stand once.
  while (count_entries(level) > most_entries && start_.size() > 2) {
    cell_ *= 2;
    set_cells(all);
  }
  std::inclusive_scan(start_.begin(), start_.end(), start_.begin());
  triangles_.resize(start_.back());
  // Filled from the back, so that `start_` ends up at the first of each cell.
  visit_all(level, [&](std::uint32_t t, std::size_t cell) {
    triangles_[std::atomic_ref(start_[cell]).fetch_sub(1, std::memory_order_relaxed) - 1] = t;
  });
}

template TriangleGrid::TriangleGrid(const Given&, std::uint64_t);
template TriangleGrid::TriangleGrid(const Midpoints&, std::uint64_t);

}  // namespace vdwmesh
