// Triangles of a level binned by place, to find those that may cross.
#pragma once

#include <cmath>
#include <cstdint>

#include "extract/indexed_mesh.hpp"
#include "refine/level_view.hpp"

namespace vdwmesh {

// Each triangle stands in the cell of the middle of the box of where its vertices were and are, and
// no box is wider than a cell: whatever moves are taken back, triangles that touch are in the same
// cell or in neighbouring ones. Within a cell the order depends on the threads.
class TriangleGrid {
 public:
  template <class Level>
  explicit TriangleGrid(const Level& level);

  // Calls visit(triangle) for all triangles in the cell of `triangle` and its neighbours.
  template <class Visit>
  void visit_near(std::size_t triangle, const Visit& visit) const {
    const std::uint32_t at = cell_of_[triangle];
    const std::uint32_t x = at % cells_[0], y = at / cells_[0] % cells_[1],
                        z = at / cells_[0] / cells_[1];
    const auto low = [](std::uint32_t i) { return i > 0 ? i - 1 : 0; };
    const auto high = [this](std::uint32_t i, int axis) {
      return i + 1 < cells_[axis] ? i + 1 : i;
    };
    for (std::uint32_t k = low(z); k <= high(z, 2); ++k) {
      for (std::uint32_t j = low(y); j <= high(y, 1); ++j) {
        const std::uint32_t row = (k * cells_[1] + j) * cells_[0];
        const std::uint32_t end = start_[row + high(x, 0) + 1];
        for (std::uint32_t i = start_[row + low(x)]; i < end; ++i) visit(triangle_[i]);
      }
    }
  }

 private:
  void sort(std::size_t cell_count);

  std::uint32_t cells_[3] = {1, 1, 1};
  Buffer<std::uint32_t> cell_of_;   // of each triangle
  Buffer<std::uint32_t> start_;     // of each cell, and the end
  Buffer<std::uint32_t> triangle_;  // by cell
};

extern template TriangleGrid::TriangleGrid(const Given&);
extern template TriangleGrid::TriangleGrid(const Midpoints&);

}  // namespace vdwmesh
