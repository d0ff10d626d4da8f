// CellLists: numbers sorted into the cells of a regular grid. For the library's own use.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::remesh {

class CellLists {
 public:
  // Cells of this size (Å) that fill the box. There are at most kMostCells: then cells are larger.
  CellLists(const Box& box, double cell) : lower_(box.lower), cell_(cell) {
    const Vec3d side = box.upper - box.lower;
    const double volume = (side.x + cell) * (side.y + cell) * (side.z + cell);
    cell_ = std::max(cell, std::cbrt(volume / kMostCells));
    for (int axis = 0; axis < 3; ++axis) {
      count_[axis] = static_cast<std::int64_t>(side[axis] / cell_) + 1;
    }
    first_.assign(cell_count() + 1, 0);
  }

  std::size_t cell_count() const {
    return static_cast<std::size_t>(count_[0] * count_[1] * count_[2]);
  }
  // The cell that contains a point, or cell_count() outside of the box.
  std::size_t cell_of(const Vec3d& p) const {
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double place = (p[axis] - lower_[axis]) / cell_;
      if (!(place >= 0 && place < static_cast<double>(count_[axis]))) return cell_count();
      at[axis] = static_cast<std::int64_t>(place);
    }
    return index(at[0], at[1], at[2]);
  }
  std::span<const std::uint32_t> at(std::size_t cell) const {
    return std::span(entries_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

  // Calls visit(cell, box of the cell) for all cells that a box touches.
  template <class Visit>
  void visit_cells(const Box& box, const Visit& visit) const {
    std::int64_t from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
      from[axis] = clamped((box.lower[axis] - lower_[axis]) / cell_, axis);
      to[axis] = clamped((box.upper[axis] - lower_[axis]) / cell_, axis);
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        for (std::int64_t x = from[0]; x <= to[0]; ++x) {
          const Vec3d corner = lower_ + cell_ * cast<double>(Vec3i{x, y, z});
          visit(index(x, y, z), Box{corner, corner + Vec3d{cell_, cell_, cell_}});
        }
      }
    }
  }

  // Fills the lists: each(add) calls add(cell, number), all calls of one number one after the
  // other. It is called twice, and must do the same both times. A number stands in a list once.
  template <class Each>
  void fill(const Each& each) {
    count_entries(each);
    for (std::size_t c = 0; c < cell_count(); ++c) first_[c + 1] += first_[c];
    entries_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    std::vector<std::uint32_t> last(cell_count(), kNone);
    each([&](std::size_t cell, std::uint32_t number) {
      if (last[cell] != number) entries_[next[cell]++] = number;
      last[cell] = number;
    });
  }

 private:
  static constexpr double kMostCells = 1 << 26;  // of 8 to 24 bytes each
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  template <class Each>
  void count_entries(const Each& each) {
    std::vector<std::uint32_t> last(cell_count(), kNone);
    each([&](std::size_t cell, std::uint32_t number) {
      if (last[cell] != number) ++first_[cell + 1];
      last[cell] = number;
    });
  }
  std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return static_cast<std::size_t>((z * count_[1] + y) * count_[0] + x);
  }
  std::int64_t clamped(double place, int axis) const {
    return static_cast<std::int64_t>(
        std::clamp(std::floor(place), 0.0, static_cast<double>(count_[axis] - 1)));
  }

  Vec3d lower_;
  double cell_;
  std::int64_t count_[3];
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> entries_;
};

}  // namespace vdwmesh::remesh
