// triangulate(): from spheres to the arrays of a regular triangulation.
//
// 1. placed_balls() numbers the balls by their places and scales them.
// 2. The cells are made in blocks of space, side by side (joined_cells.hpp).
// 3. Cells are sorted by their vertices, so that their order does not depend on the blocks.
#include "complex/power_triangulation.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <utility>

#include "complex/joined_cells.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"

namespace vdwmesh {
namespace {

// The vertices of a cell, and its place in the list that it comes from.
using PlacedCell = std::pair<CellVertices, std::uint32_t>;

// Puts the cells in the order of their vertices, sorted by the lowest one first, so that cells near
// in space are near in memory, and the order is that of any other list of the same cells.
// `vertices` counts the auxiliary points too.
void store_sorted(const RegularCells& cells, std::size_t vertices, PowerTriangulation& out) {
  const std::size_t count = cells.cells.size();
  SortedRows<PlacedCell> sorted;
  sorted.fill(vertices, count, [&](std::size_t c, const auto& add) {
    add(cells.cells[c][0], {cells.cells[c], static_cast<std::uint32_t>(c)});
  });
  const std::span<const PlacedCell> entries = std::as_const(sorted).entries();
  Buffer<std::uint32_t> number(count);  // by place
  for_each_index(count,
                 [&](std::size_t i) { number[entries[i].second] = static_cast<std::uint32_t>(i); });
  out.cells.resize(count);
  out.neighbors.resize(count);
  for_each_index(count, [&](std::size_t i) {
    const auto& [vertices_of_cell, place] = entries[i];
    out.cells[i] = vertices_of_cell;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t n = cells.neighbors[place][k];
      out.neighbors[i][k] = n == kNoIndex ? n : number[n];
    }
  });
}

// As many blocks as there are cores, but not of fewer balls than are worth the margin around them.
std::size_t blocks_for_cores(std::size_t balls) {
  constexpr std::size_t kLeastBalls = 5000;
  const auto cores =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::max<std::size_t>(1, std::min(cores, balls / kLeastBalls));
}

}  // namespace

PowerTriangulation triangulate(const SphereSet& spheres, Monitor* monitor,
                               std::optional<std::size_t> blocks, std::uint64_t memory_limit) {
  return triangulate(placed_balls(spheres), monitor, blocks, memory_limit);
}

PowerTriangulation triangulate(PlacedBalls&& balls, Monitor* monitor,
                               std::optional<std::size_t> blocks, std::uint64_t memory_limit) {
  PowerTriangulation out{std::move(balls), {}, {}};
  const std::array<Vec3d, 4> auxiliary = auxiliary_points(out.balls);
  const RegularCells cells =
      joined_cells(out.balls, auxiliary, blocks.value_or(blocks_for_cores(out.balls.size())),
                   memory_limit, monitor);
  store_sorted(cells, out.balls.size() + auxiliary.size(), out);
  return out;
}

}  // namespace vdwmesh
