// A uniform grid over the patches of a level. It finds the pairs of patches whose triangles may
// cross, so that only these are tested and not all pairs. BadMoves builds one per level; patches
// are explained in level_view.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/buffer.hpp"
#include "refine/crossings/part_boxes.hpp"
#include "refine/level_view.hpp"

namespace vdwmesh {

// A box in single precision, Å, relative to the origin of the grid, the first vertex of its first
// patch. All coordinates are rounded
// alike, which keeps their order: boxes of which these have no point in common have none either.
struct PatchBox {
  std::array<float, 3> lower, upper;
};

// A uniform grid with at most two cells per patch, or 64 cells if that is more. Each patch is
// listed in every cell that its box touches. The box holds the triangles of the patch with any
// choice of their vertices before and after their moves: it has all these positions, and a triangle
// lies in the hull of its corners. So the boxes of two patches with triangles that cross overlap,
// whichever moves are taken back, and both patches are listed in the cell of any common point of
// the boxes. The order of the patches within a cell depends on the threads.
class PatchGrid {
 public:
  // An entry is one patch in the list of one cell. Offsets of entries have 32 bits.
  static constexpr std::uint64_t kMostEntries = std::numeric_limits<std::uint32_t>::max();

  // Enlarges the cells until there are at most `most_entries` entries. Precondition: the level has
  // at most `most_entries` patches. The last resort, a grid of one cell, then succeeds, because
  // each patch has one entry in it.
  template <class Level>
  explicit PatchGrid(const Level& level, std::uint64_t most_entries = kMostEntries);

  std::size_t cell_count() const { return start_.size() - 1; }
  std::span<const std::uint32_t> patches_in(std::size_t cell) const {
    return {patches_.data() + start_[cell], patches_.data() + start_[cell + 1]};
  }
  const PatchBox& box_of_patch(std::size_t patch) const { return boxes_[patch]; }
  // The boxes of the parts of a patch. Precondition: it has several. A midpoint starts between
  // corners of its part, which never move, so the box of the part has it before and after its move.
  const PartBoxes& boxes_of_parts(std::size_t patch) const { return part_boxes_[patch]; }
  // At least the distance (Å) of two coordinates of which these are the ones of boxes.
  static double length_of(float lower, float upper) {
    // A coordinate was rounded to a double and to a float: by less than 2^-22 of the float's size,
    // or 2^-148 Å if that is tiny.
    constexpr double kRounding = 0x1p-22, kTiny = 0x1p-148;
    const double from = static_cast<double>(lower), to = static_cast<double>(upper);
    return to - from + kRounding * (std::abs(from) + std::abs(to)) + kTiny;
  }
  // The numbers of a cell along x, y, z.
  using Place = std::array<std::uint32_t, 3>;
  Place place_of(std::size_t cell) const {
    const std::size_t row = cell / cells_[0];
    return {static_cast<std::uint32_t>(cell % cells_[0]),
            static_cast<std::uint32_t>(row % cells_[1]),
            static_cast<std::uint32_t>(row / cells_[1])};
  }
  // The place of the cell of a corner of a patch's box.
  Place place_of(const std::array<float, 3>& p) const {
    return {cell_along(0, p[0]), cell_along(1, p[1]), cell_along(2, p[2])};
  }

  // Calls visit(cell) for every cell that the box of the patch touches, with the index of the cell.
  template <class Visit>
  void visit_cells(std::size_t patch, const Visit& visit) const {
    const Place low = place_of(boxes_[patch].lower), high = place_of(boxes_[patch].upper);
    for (std::size_t z = low[2]; z <= high[2]; ++z) {
      for (std::size_t y = low[1]; y <= high[1]; ++y) {
        const std::size_t row = (z * cells_[1] + y) * cells_[0];
        for (std::size_t x = low[0]; x <= high[0]; ++x) visit(row + x);
      }
    }
  }

 private:
  struct Extent;

  // The index, along one axis, of the cell that holds the coordinate. One between the ends of a box
  // gets an index between those of the ends. The minima catch rounding at the end of the grid and
  // infinity; the maximum catches minus infinity and, as 0 comes first, NaN, which is 0 times
  // infinity if there is one cell.
  std::uint32_t cell_along(std::size_t axis, float coordinate) const {
    const double place = (static_cast<double>(coordinate) - lower_[axis]) * per_cell_;
    return std::min(static_cast<std::uint32_t>(std::min(std::max(0.0, place), kMostCells)),
                    cells_[axis] - 1);
  }
  template <class Level>
  Extent find_boxes(const Level& level);
  void choose_cells(const Extent& extent);
  double cells_along(std::size_t axis, double width) const;
  double cells_in(double width) const;
  void set_cells(double width);
  template <class Visit>
  void visit_all(const Visit& visit) const;
  std::uint64_t count_entries();

  static constexpr double kMostCells = 4294967295.0;  // fits a number of 32 bits
  std::array<double, 3> lower_{0, 0, 0};              // lower corner of cell 0, Å, from the origin
  std::array<double, 3> sides_{0, 0, 0};              // of the box around all boxes, Å
  double cell_ = 1, per_cell_ = 1;                    // width of a cell, Å, and its inverse
  std::array<std::uint32_t, 3> cells_{1, 1, 1};       // number of cells along x, y, z
  Buffer<PatchBox> boxes_;                            // by patch
  Buffer<PartBoxes> part_boxes_;                      // by patch, if patches have several parts
  // Compressed sparse rows: cell c lists patches_[start_[c]] to patches_[start_[c + 1] - 1].
  Buffer<std::uint32_t> start_;
  Buffer<std::uint32_t> patches_;
};

extern template PatchGrid::PatchGrid(const Given&, std::uint64_t);
extern template PatchGrid::PatchGrid(const Midpoints&, std::uint64_t);
extern template PatchGrid::PatchGrid(const DividedMidpoints&, std::uint64_t);

}  // namespace vdwmesh
