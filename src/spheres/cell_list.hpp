// Spheres sorted into the cells of regular grids by the positions of their centres, so that the
// spheres near a box are found fast. Host and device.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "core/host_device.hpp"
#include "spheres/cell_list_frame.hpp"
#include "spheres/list_place.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A cell list as host and device code read it; trivially copyable, owns nothing. Spheres are in
// list order: level by level, within a level cell by cell (x fastest, z slowest), and within a cell
// in canonical order. Every query visits its spheres in this one order, so sums over the spheres
// near two overlapping boxes add the spheres that they share in the same order.
struct CellListView {
  static constexpr int kMaxLevels = 24;
  struct Level : CellLevel {
    // List place of the first sphere of each cell, and one more element: the end of the level.
    const std::uint32_t* cell_start;
  };
  ByListPlace<Sphere> spheres;
  ByListPlace<Rank> rank;    // breaks ties
  ByListPlace<SphereId> id;  // in the SphereSet
  std::uint32_t size;        // number of spheres
  int level_count;
  Level levels[kMaxLevels];
};

// A cell list of several levels. The reach of a sphere says how far from its centre it matters. The
// spheres whose reaches are within a factor of two share a level, a grid whose cells are about as
// wide as these reaches. So one giant sphere does not slow the search for the small ones.
class CellList {
 public:
  CellList() = default;
  // `reach[i]` is the reach of sphere i (Å, above 0).
  CellList(const SphereSet& spheres, std::span<const double> reach);
  // A list with given cells. Throws InvalidInput if a sphere's centre lies outside the cells of its
  // level or its reach is larger than the level's.
  CellList(const SphereSet& spheres, std::span<const double> reach, const CellListFrame& frame);

  CellList(CellList&&) = default;
  CellList& operator=(CellList&&) = default;

  // Replaces the list by what the constructor with these arguments makes, and reuses its memory.
  // Views of the old list become invalid.
  void rebuild(const SphereSet& spheres, std::span<const double> reach);
  void rebuild(const SphereSet& spheres, std::span<const double> reach, const CellListFrame& frame);

  // The view is valid until the list is rebuilt or destroyed; moving the list keeps it valid.
  const CellListView& view() const { return view_; }

 private:
  struct Members;
  struct Layout;

  Members choose_levels(const SphereSet& spheres, std::span<const double> reach,
                        const CellListFrame& frame);
  Layout lay_out(const CellListFrame& frame, const Members& members);
  void find_cells(const SphereSet& spheres, const CellListFrame& frame, const Layout& layout);
  void sort_by_cell(const SphereSet& spheres, std::size_t cells);

  Buffer<Sphere> spheres_;
  Buffer<Rank> rank_;
  Buffer<SphereId> id_;
  Buffer<std::uint32_t> cell_start_;  // of all levels, and one more element: the end of the list
  CellListView view_{};
  // Used only while a list is built. order_: sphere id by rank. level_of_rank_, cell_of_rank_:
  // level and cell by rank. ranks_: in list order, but within a group of cells by rank.
  std::vector<SphereId> order_;
  Buffer<std::uint8_t> level_of_rank_;
  Buffer<std::uint64_t> cell_of_rank_;
  Buffer<std::uint32_t> ranks_;
};

// A cell list in which the reach of a sphere is its radius, for queries about the balls themselves.
CellList make_ball_list(const SphereSet& spheres);

// The cell of a level, along one axis, that holds the coordinate x (Å). Precondition: it is one of
// the level's, but for rounding.
VDWMESH_HD inline std::int32_t cell_along(const CellLevel& level, int axis, double x) {
  const auto cell = static_cast<std::int32_t>((x - level.origin[axis]) / level.cell_size);
  const std::int32_t last = level.cells[axis] - 1;
  return cell < 0 ? 0 : cell < last ? cell : last;
}

// A superset of the cells of a level, along one axis, that can hold a centre at a distance of at
// most `level.reach` from the interval [lower, upper] (Å).
struct CellRange {
  std::int32_t first, last;  // empty if first > last
};
VDWMESH_HD inline CellRange cell_range(const CellLevel& level, int axis, double lower,
                                       double upper) {
  const double inverse = 1.0 / level.cell_size;
  const double count = static_cast<double>(level.cells[axis]);
  // Slack of 1e-9 cell widths: it covers the rounding of the products.
  const double a = (lower - level.reach - level.origin[axis]) * inverse - 1e-9;
  const double b = (upper + level.reach - level.origin[axis]) * inverse + 1e-9;
  if (!(b >= 0) || !(a < count)) return {0, -1};
  const std::int32_t first = a > 0 ? static_cast<std::int32_t>(a) : 0;
  const std::int32_t last = b < count ? static_cast<std::int32_t>(b) : level.cells[axis] - 1;
  return {first, last};
}

// Calls visit_row(first, end) for ranges of list places, in list order, that together hold a
// superset of the spheres whose reach touches the box. If visit_row() returns true, the function
// stops and returns true; if it always returns false, the function returns false.
template <class VisitRow>
VDWMESH_HD bool visit_rows_near_box(const CellListView& list, const Vec3d& lower,
                                    const Vec3d& upper, VisitRow&& visit_row) {
  for (int l = 0; l < list.level_count; ++l) {
    const CellListView::Level& level = list.levels[l];
    const CellRange rx = cell_range(level, 0, lower.x, upper.x);
    const CellRange ry = cell_range(level, 1, lower.y, upper.y);
    const CellRange rz = cell_range(level, 2, lower.z, upper.z);
    if (rx.first > rx.last) continue;
    for (std::int32_t z = rz.first; z <= rz.last; ++z) {
      for (std::int32_t y = ry.first; y <= ry.last; ++y) {
        const std::int64_t row =
            (static_cast<std::int64_t>(z) * level.cells[1] + y) * level.cells[0];
        // The cells of a row along x are consecutive, so their spheres are consecutive in the list.
        const ListPlace first{level.cell_start[row + rx.first]};
        if (visit_row(first, ListPlace{level.cell_start[row + rx.last + 1]})) return true;
      }
    }
  }
  return false;
}

// Calls visit(place) with the list place of each sphere of some superset of the spheres whose reach
// touches the box, in list order. If visit() returns true, the function stops and returns true; if
// visit() always returns false, the function visits all and returns false.
template <class Visit>
VDWMESH_HD bool visit_near_box(const CellListView& list, const Vec3d& lower, const Vec3d& upper,
                               Visit&& visit) {
  return visit_rows_near_box(list, lower, upper, [&](ListPlace first, ListPlace end) {
    for (std::uint32_t i = to_index(first); i < to_index(end); ++i) {
      if (visit(ListPlace{i})) return true;
    }
    return false;
  });
}

}  // namespace vdwmesh
