#include "refine/triangle_grid.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "core/blocks.hpp"
#include "core/errors.hpp"

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

double cells_along(const Bounds& all, double cell, int axis) {
  return std::floor((all.upper[axis] - all.lower[axis]) / cell) + 1;
}

}  // namespace

Bounds no_bounds() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

std::uint32_t TriangleGrid::cell_along(int axis, double coordinate) const {
  const double place = std::max((coordinate - origin_[axis]) / cell_, 0.0);
  return std::min(static_cast<std::uint32_t>(place), cells_[static_cast<std::size_t>(axis)] - 1);
}

template <class Level>
void TriangleGrid::shape(const Level& level) {
  const double triangles = static_cast<double>(level.patches() * Level::kTriangles);
  const Extent extent = extent_of(level);
  origin_ = extent.all.lower;
  cell_ = std::max(kCellWidth * extent.width_sum / triangles, 1e-100);
  const double most = std::max(64.0, 2 * triangles);
  for (;;) {
    double total = 1;
    for (int axis = 0; axis < 3; ++axis) total *= cells_along(extent.all, cell_, axis);
    if (total <= most) break;
    cell_ *= std::max(1.01, std::cbrt(total / most));
  }
  for (int axis = 0; axis < 3; ++axis) {
    cells_[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(cells_along(extent.all, cell_, axis));
  }
}

template <class Level>
TriangleGrid::TriangleGrid(const Level& level) {
  if (level.patches() > 0) shape(level);
  start_.assign(std::size_t{cells_[0]} * cells_[1] * cells_[2] + 1, 0);
  const auto visit_all = [&](const auto& visit) {
    for_all(level.patches(), [&](std::size_t patch) {
      const auto v = level.vertices(patch);
      for (int child = 0; child < Level::kTriangles; ++child) {
        const std::size_t t = Level::kTriangles * patch + static_cast<std::size_t>(child);
        visit_cells(bounds_of(level, v, child),
                    [&](std::size_t cell) { visit(static_cast<std::uint32_t>(t), cell); });
      }
    });
  };
  visit_all([&](std::uint32_t, std::size_t cell) {
    std::atomic_ref(start_[cell]).fetch_add(1, std::memory_order_relaxed);
  });
  std::uint64_t sum = 0;
  for (std::uint32_t& n : start_) {
    sum += n;
    if (sum > std::numeric_limits<std::uint32_t>::max()) {
      throw LimitExceeded("too many triangles to look for crossings: use fewer subdivisions");
    }
    n = static_cast<std::uint32_t>(sum);
  }
  triangles_.resize(sum);
  // Filled from the back, so that `start_` ends up at the first of each cell.
  visit_all([&](std::uint32_t t, std::size_t cell) {
    triangles_[std::atomic_ref(start_[cell]).fetch_sub(1, std::memory_order_relaxed) - 1] = t;
  });
}

template TriangleGrid::TriangleGrid(const Given&);
template TriangleGrid::TriangleGrid(const Midpoints&);

}  // namespace vdwmesh
