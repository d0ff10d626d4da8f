// Points in the cells of a grid, for searches around others. For the library's own use.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

class PointGrid {
 public:
  // The cells are about so wide (Å), or wider where the points lie far apart.
  PointGrid(std::span<const Vec3d> points, double cell);

  // Whether a point is nearer than this, Å.
  bool has_within(const Vec3d& place, double distance) const {
    const double squared = distance * distance;
    return visit(place, squared,
                 [&](std::uint32_t i) { return squared_distance(points_[i], place) < squared; });
  }

  // The index of the nearest point, the lowest of several, if there is one up to `most` (Å).
  std::optional<std::uint32_t> nearest(const Vec3d& place, double most) const {
    double least = most * most;
    std::optional<std::uint32_t> found;
    visit(place, least, [&](std::uint32_t i) {
      const double squared = squared_distance(points_[i], place);
      if (squared > least || (found && squared == least && id_[i] > *found)) return false;
      least = squared;
      found = id_[i];
      return false;
    });
    return found;
  }

  // Calls near(index, squared distance) for all points up to this squared distance, Å², which
  // near() may lower, and for some that are farther.
  template <class Near>
  void each_near(const Vec3d& place, const double& squared, const Near& near) const {
    visit(place, squared, [&](std::uint32_t i) {
      near(id_[i], squared_distance(points_[i], place));
      return false;
    });
  }

 private:
  struct CellRun {
    std::int32_t first, last;
  };
  CellRun cells_along(int axis, double from, double to) const {
    const auto along = [&](double x) {
      const double cell = (x - lower_[axis]) / width_;
      return static_cast<std::int32_t>(std::clamp(cell, -1.0, 1.0 * count_[axis]));
    };
    return {std::max(along(from), 0), std::min(along(to), count_[axis] - 1)};
  }
  std::size_t row(std::int32_t y, std::int32_t z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(y)) *
           static_cast<std::size_t>(count_[0]);
  }

  // In plain products: without the compiler option -mfma a std::fma is a call.
  static double squared_distance(const Vec3d& a, const Vec3d& b) {
    const double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return x * x + y * y + z * z;
  }
  // How far a coordinate is from those of a cell.
  double beside(int axis, std::int32_t cell, double x) const {
    const double lower = lower_[axis] + cell * width_;
    return std::max({0.0, lower - x, x - lower - width_});
  }

  // Visits the points of cells that may be as near as the squared distance, which visitor() may
  // lower, until it returns true; and returns whether it did. Cells of a row along x follow each
  // other. The slack is for rounding.
  template <class Visit>
  bool visit(const Vec3d& place, const double& squared, const Visit& visitor) const {
    if (points_.empty()) return false;
    constexpr double kSlack = 1 + 1e-9;
    const double widest = std::sqrt(squared) * kSlack;
    const CellRun z = cells_along(2, place.z - widest, place.z + widest);
    for (std::int32_t k = z.first; k <= z.last; ++k) {
      const double across = beside(2, k, place.z), left = squared * kSlack - across * across;
      if (left < 0) continue;
      const double wide = std::sqrt(left) * kSlack;
      const CellRun x = cells_along(0, place.x - wide, place.x + wide),
                    y = cells_along(1, place.y - wide, place.y + wide);
      if (x.first > x.last) continue;
      for (std::int32_t j = y.first; j <= y.last; ++j) {
        const double up = beside(1, j, place.y);
        if (up * up > squared * kSlack - across * across) continue;
        const std::size_t first = row(j, k);
        const std::uint32_t end = begin_[first + static_cast<std::size_t>(x.last) + 1];
        for (std::uint32_t i = begin_[first + static_cast<std::size_t>(x.first)]; i < end; ++i)
          if (visitor(i)) return true;
      }
    }
    return false;
  }

  Vec3d lower_{0, 0, 0};
  double width_ = 1;
  std::array<std::int32_t, 3> count_{1, 1, 1};
  std::vector<Vec3d> points_;         // by cell
  std::vector<std::uint32_t> id_;     // of each, its index
  std::vector<std::uint32_t> begin_;  // by cell, and the end
};

}  // namespace vdwmesh
