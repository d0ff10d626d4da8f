// PointGrid: counts the points of each cell, and sorts them by cell in their order.
#include "interface/point_grid.hpp"

#include <cmath>
#include <numeric>

#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

// A grid has at most so many cells for each point, and some more.
constexpr double kCellsPerPoint = 64, kCellsMore = 4096;

}  // namespace

PointGrid::PointGrid(std::span<const Vec3d> points, double cell) : width_(cell) {
  if (points.empty()) return;
  const Box box = box_around(points);
  lower_ = box.lower;
  const Vec3d extent = box.upper - box.lower;
  const auto cells = [&] {
    return (extent.x / width_ + 1) * (extent.y / width_ + 1) * (extent.z / width_ + 1);
  };
  while (cells() > kCellsPerPoint * static_cast<double>(points.size()) + kCellsMore) width_ *= 2;
  for (int axis = 0; axis < 3; ++axis)
    count_[static_cast<std::size_t>(axis)] = static_cast<std::int32_t>(extent[axis] / width_) + 1;
  const auto cell_of = [&](const Vec3d& p) {
    return row(cells_along(1, p.y, p.y).first, cells_along(2, p.z, p.z).first) +
           static_cast<std::size_t>(cells_along(0, p.x, p.x).first);
  };
  begin_.assign(row(0, count_[2]) + 2, 0);
  for (const Vec3d& point : points) ++begin_[cell_of(point) + 2];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  points_.resize(points.size());
  id_.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const std::uint32_t place = begin_[cell_of(points[i]) + 1]++;
    points_[place] = points[i];
    id_[place] = i;
  }
}

}  // namespace vdwmesh
