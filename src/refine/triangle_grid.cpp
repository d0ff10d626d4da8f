#include "refine/triangle_grid.hpp"

#include <algorithm>
#include <atomic>
#include <limits>

#include "refine/blocks.hpp"

namespace vdwmesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Bounds {
  Vec3d lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  double widest = 0;  // of the boxes joined

  void add(const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], p[axis]);
      upper[axis] = std::max(upper[axis], p[axis]);
    }
  }
  double width() const {
    return std::max({upper.x - lower.x, upper.y - lower.y, upper.z - lower.z, 0.0});
  }
};

Bounds join(Bounds a, const Bounds& b) {
  a.add(b.lower);
  a.add(b.upper);
  a.widest = std::max(a.widest, b.widest);
  return a;
}

// The box of where the vertices of a patch's triangle were and are.
template <class Level>
Bounds box_of(const Level& level, const std::array<std::uint32_t, Level::kVertices>& v, int child) {
  Bounds box;
  for (const int k : Level::triangle(child)) {
    const auto i = static_cast<std::size_t>(k);
    box.add(level.before(v, i));
    box.add(level.mesh.positions[v[i]]);
  }
  return box;
}

template <class Level>
Bounds bounds_of(const Level& level) {
  const auto add = [&](std::size_t patch, Bounds& total) {
    const auto v = level.vertices(patch);
    for (int child = 0; child < Level::kTriangles; ++child) {
      Bounds box = box_of(level, v, child);
      box.widest = box.width();
      total = join(total, box);
    }
  };
  return reduce_all(level.patches(), Bounds{}, add, join);
}

// Cells along an axis. The quotient's rounding cannot matter: cells are a little wider than boxes.
std::uint32_t cells_along(const Bounds& all, double cell, int axis) {
  return static_cast<std::uint32_t>(std::min((all.upper[axis] - all.lower[axis]) / cell, 1e9)) + 1;
}

// As wide as the widest box, widened until there are at most as many cells as triangles.
double cell_width(const Bounds& all, std::size_t triangles) {
  double cell = std::max(all.widest * (1 + 1e-6), 1e-300);
  for (;;) {
    double total = 1;
    for (int axis = 0; axis < 3; ++axis) total *= cells_along(all, cell, axis);
    const double most = std::max(64.0, static_cast<double>(triangles));
    if (total <= most) return cell;
    cell *= std::max(1.01, std::cbrt(total / most));
  }
}

}  // namespace

template <class Level>
TriangleGrid::TriangleGrid(const Level& level)
    : cell_of_(level.patches() * Level::kTriangles), triangle_(cell_of_.size()) {
  if (cell_of_.empty()) return;
  const Bounds all = bounds_of(level);
  const double cell = cell_width(all, cell_of_.size());
  for (int axis = 0; axis < 3; ++axis) cells_[axis] = cells_along(all, cell, axis);
  for_all(level.patches(), [&](std::size_t patch) {
    const auto v = level.vertices(patch);
    for (int child = 0; child < Level::kTriangles; ++child) {
      const Bounds box = box_of(level, v, child);
      std::uint32_t at[3];
      for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * (box.lower[axis] + box.upper[axis]);
        const double place = std::max((middle - all.lower[axis]) / cell, 0.0);
        at[axis] = std::min(static_cast<std::uint32_t>(place), cells_[axis] - 1);
      }
      cell_of_[Level::kTriangles * patch + static_cast<std::size_t>(child)] =
          (at[2] * cells_[1] + at[1]) * cells_[0] + at[0];
    }
  });
  sort(std::size_t{cells_[0]} * cells_[1] * cells_[2]);
}

void TriangleGrid::sort(std::size_t cell_count) {
  start_.assign(cell_count + 1, 0);
  for_all(cell_of_.size(), [&](std::size_t t) {
    std::atomic_ref(start_[cell_of_[t]]).fetch_add(1, std::memory_order_relaxed);
  });
  std::uint32_t sum = 0;
  for (std::uint32_t& n : start_) n = sum += n;
  // Filled from the back, so that `start_` ends up at the first of each cell.
  for_all(cell_of_.size(), [&](std::size_t t) {
    const std::uint32_t end =
        std::atomic_ref(start_[cell_of_[t]]).fetch_sub(1, std::memory_order_relaxed);
    triangle_[end - 1] = static_cast<std::uint32_t>(t);
  });
}

template TriangleGrid::TriangleGrid(const Given&);
template TriangleGrid::TriangleGrid(const Midpoints&);

}  // namespace vdwmesh
