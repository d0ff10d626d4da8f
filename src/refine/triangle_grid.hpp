// A uniform grid over the triangles of a level. It finds the pairs that may cross, so that only
// these are tested and not all pairs. BadMoves builds one per level; patches are explained in
// level_view.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "refine/level_view.hpp"
#include "surface/box.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The bounding box of triangle `child` of the patch with vertices v. It holds the triangle with any
// choice of its vertices before and after their moves: the box has all six positions, and a
// triangle lies in the hull of its corners. So the box is right whichever moves are taken back.
template <class Level>
Box bounds_of(const Level& level, const std::array<std::uint32_t, Level::kVertices>& v, int child) {
  Box box = empty_box();
  for (const int k : Level::triangle(child)) {
    const auto i = static_cast<std::size_t>(k);
    include(box, level.before(v, i));
    include(box, level.mesh.positions[v[i]]);
  }
  return box;
}

// A uniform grid with at most two cells per triangle, or 64 cells if that is more. Each triangle is
// listed in every cell that its box (bounds_of()) touches. The boxes of two triangles that cross
// overlap, whichever moves are taken back, and both are listed in the cell of any common point of
// the boxes. The order of the triangles within a cell depends on the threads.
class TriangleGrid {
 public:
  // An entry is one triangle in the list of one cell. Offsets of entries have 32 bits.
  static constexpr std::uint64_t kMostEntries = std::numeric_limits<std::uint32_t>::max();

  // Enlarges the cells until there are at most `most_entries` entries. Precondition: the level has
  // at most `most_entries` triangles. The last resort, a grid of one cell, then succeeds, because
  // each triangle has one entry in it.
  template <class Level>
  explicit TriangleGrid(const Level& level, std::uint64_t most_entries = kMostEntries);

  std::size_t cell_count() const { return start_.size() - 1; }
  std::span<const std::uint32_t> triangles_in(std::size_t cell) const {
    return {triangles_.data() + start_[cell], triangles_.data() + start_[cell + 1]};
  }

  // Calls visit(cell) for every cell that the box touches, with the index of the cell.
  template <class Visit>
  void visit_cells(const Box& box, const Visit& visit) const {
    std::array<std::uint32_t, 3> low, high;
    for (int axis = 0; axis < 3; ++axis) {
      low[static_cast<std::size_t>(axis)] = cell_along(axis, box.lower[axis]);
      high[static_cast<std::size_t>(axis)] = cell_along(axis, box.upper[axis]);
    }
    for (std::size_t z = low[2]; z <= high[2]; ++z) {
      for (std::size_t y = low[1]; y <= high[1]; ++y) {
        const std::size_t row = (z * cells_[1] + y) * cells_[0];
        for (std::size_t x = low[0]; x <= high[0]; ++x) visit(row + x);
      }
    }
  }

 private:
  std::uint32_t cell_along(int axis, double coordinate) const;
  template <class Level>
  Box choose_cells(const Level& level);
  void set_cells(const Box& all);
  template <class Level, class Visit>
  void visit_all(const Level& level, const Visit& visit) const;
  template <class Level>
  std::uint64_t count_entries(const Level& level);

  Vec3d origin_{0, 0, 0};                        // lower corner of cell 0, Å
  double cell_ = 1;                              // width of a cell, Å
  std::array<std::uint32_t, 3> cells_{1, 1, 1};  // number of cells along x, y, z
  // Compressed sparse rows: cell c lists triangles_[start_[c]] to triangles_[start_[c + 1] - 1].
  Buffer<std::uint32_t> start_;
  Buffer<std::uint32_t> triangles_;
};

extern template TriangleGrid::TriangleGrid(const Given&, std::uint64_t);
extern template TriangleGrid::TriangleGrid(const Midpoints&, std::uint64_t);

}  // namespace vdwmesh
