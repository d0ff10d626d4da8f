// Spheres binned by position, for host and device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/host_device.hpp"
#include "spheres/cell_list_frame.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A cell list as host and device code read it; trivially copyable, owns nothing. Spheres stand in
// list order: level by level, cell by cell (z-y-x), in canonical order within a cell. That is one
// global order: any query yields its spheres in it, so sums over the spheres near two overlapping
// boxes round alike.
struct CellListView {
  static constexpr int kMaxLevels = 24;
  struct Level : CellLevel {
    const std::uint32_t* cell_start;  // cells.x * cells.y * cells.z + 1 offsets into the list
  };
  const Sphere* spheres;      // in list order
  const std::uint32_t* rank;  // list place -> rank in the canonical order, which breaks ties
  const SphereId* id;         // list place -> id in the SphereSet
  std::uint32_t size;
  int level_count;
  Level levels[kMaxLevels];
};

// A multi-level cell list: spheres of like reach share a level whose cells are about as wide as
// that reach, so one giant sphere does not slow the search for the small ones.
class CellList {
 public:
  CellList() = default;
  // `reach[i]` (Å, above 0): how far from its centre sphere i matters.
  CellList(const SphereSet& spheres, std::span<const double> reach);
  // The same with cells that are given. Throws InvalidInput, naming the first sphere whose centre
  // lies beyond the cells of its level or whose reach is larger than the level's.
  CellList(const SphereSet& spheres, std::span<const double> reach, const CellListFrame& frame);

  CellList(CellList&&) = default;
  CellList& operator=(CellList&&) = default;

  // As a new list, in the memory of this one. Views of it are not valid any more.
  void rebuild(const SphereSet& spheres, std::span<const double> reach);
  void rebuild(const SphereSet& spheres, std::span<const double> reach, const CellListFrame& frame);

  // Valid until the list is rebuilt or ends; moving the list does not invalidate it.
  const CellListView& view() const { return view_; }

 private:
  void add_level(const SphereSet& spheres, const CellLevel& level, std::size_t number);

  std::vector<Sphere> spheres_;
  std::vector<std::uint32_t> rank_;
  std::vector<SphereId> id_;
  std::vector<std::vector<std::uint32_t>> cell_start_;  // one for each level of the view
  CellListView view_{};
  // While a list is built: sphere ids by rank, their levels, and the cells of a level's spheres.
  std::vector<SphereId> order_;
  std::vector<std::uint8_t> level_of_rank_;
  std::vector<std::uint32_t> cell_of_, next_;
};

// A cell list whose reach is the radius, for queries about the balls themselves.
CellList make_ball_list(const SphereSet& spheres);

// Cells of a level along one axis that can hold a centre within `level.reach` of [lower, upper].
struct CellRange {
  std::int32_t first, last;  // empty when first > last
};
VDWMESH_HD inline CellRange cell_range(const CellLevel& level, int axis, double lower,
                                       double upper) {
  const double inverse = 1.0 / level.cell_size;
  const double count = static_cast<double>(level.cells[axis]);
  // One cell-width of slack times 1e-9 covers the rounding of the two quotients.
  const double a = (lower - level.reach - level.origin[axis]) * inverse - 1e-9;
  const double b = (upper + level.reach - level.origin[axis]) * inverse + 1e-9;
  if (!(b >= 0) || !(a < count)) return {0, -1};
  const std::int32_t first = a > 0 ? static_cast<std::int32_t>(a) : 0;
  const std::int32_t last = b < count ? static_cast<std::int32_t>(b) : level.cells[axis] - 1;
  return {first, last};
}

// Calls visit(place) in list order for a superset of the spheres whose reach touches the box;
// stops early when visit returns true, and says so.
template <class Visit>
VDWMESH_HD bool visit_near_box(const CellListView& list, const Vec3d& lower, const Vec3d& upper,
                               Visit&& visit) {
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
        // Cells of a row are consecutive, and so are their spheres.
        const std::uint32_t end = level.cell_start[row + rx.last + 1];
        for (std::uint32_t place = level.cell_start[row + rx.first]; place < end; ++place) {
          if (visit(place)) return true;
        }
      }
    }
  }
  return false;
}

}  // namespace vdwmesh
