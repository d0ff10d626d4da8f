#include "spheres/cell_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/bins.hpp"

namespace vdwmesh {
namespace {

// Spheres of one level: their places in canonical order, the box of their centres, their reach.
struct LevelMembers {
  std::vector<std::uint32_t> ranks;
  Box box{};
  double reach = 0;
};

void add_member(LevelMembers& level, std::uint32_t rank, const Vec3d& center, double reach) {
  if (level.ranks.empty()) level.box = {center, center};
  for (int axis = 0; axis < 3; ++axis) {
    level.box.lower[axis] = std::min(level.box.lower[axis], center[axis]);
    level.box.upper[axis] = std::max(level.box.upper[axis], center[axis]);
  }
  level.reach = std::max(level.reach, reach);
  level.ranks.push_back(rank);
}

// What cell_range() and cell_index() lose by rounding, Å: sixteen units of the largest number in
// them. Of many small spheres far from the origin it is more than a share of the cells.
double rounding_of(const LevelMembers& members) {
  double largest = members.reach;
  for (int axis = 0; axis < 3; ++axis) {
    largest =
        std::max({largest, std::abs(members.box.lower[axis]), std::abs(members.box.upper[axis])});
  }
  return 16 * std::numeric_limits<double>::epsilon() * 2 * largest;
}

// Octave of a reach above the smallest one; the last level takes all that is larger.
int level_of(double reach, double smallest) {
  const int octave = static_cast<int>(std::floor(std::log2(reach / smallest) + 1e-12));
  return std::clamp(octave, 0, CellListView::kMaxLevels - 1);
}

// Cells as wide as the reach, or wider, so that there are at most a few per sphere.
CellListView::Level shape_of(const LevelMembers& members) {
  CellListView::Level level{};
  level.origin = members.box.lower;
  level.reach = members.reach + rounding_of(members);
  const double most = std::max(4096.0, 8.0 * static_cast<double>(members.ranks.size()));
  const Bins bins = cubic_bins(members.box.upper - members.box.lower, members.reach, most);
  level.cell_size = bins.width;
  std::ranges::copy(bins.count, level.cells);
  return level;
}

// Below kMostBins.
std::uint32_t cell_index(const CellListView::Level& level, const Vec3d& center) {
  std::int32_t cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = (center[axis] - level.origin[axis]) / level.cell_size;
    cell[axis] = std::clamp(static_cast<std::int32_t>(offset), 0, level.cells[axis] - 1);
  }
  const std::int64_t row = std::int64_t{cell[2]} * level.cells[1] + cell[1];
  return static_cast<std::uint32_t>(row * level.cells[0] + cell[0]);
}

// Offsets of each cell's spheres, beginning at `base`.
std::vector<std::uint32_t> cell_starts(const std::vector<std::uint32_t>& cell_of, std::size_t cells,
                                       std::uint32_t base) {
  std::vector<std::uint32_t> start(cells + 1, 0);
  for (const std::uint32_t cell : cell_of) ++start[cell + 1];
  start[0] = base;
  for (std::size_t c = 0; c < cells; ++c) start[c + 1] += start[c];
  return start;
}

std::vector<LevelMembers> split_by_reach(const SphereSet& spheres, std::span<const double> reach,
                                         const std::vector<SphereId>& order) {
  const double smallest = reach.empty() ? 1.0 : *std::min_element(reach.begin(), reach.end());
  std::vector<LevelMembers> levels(CellListView::kMaxLevels);
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) {
    const SphereId i = order[rank];
    add_member(levels[static_cast<std::size_t>(level_of(reach[i], smallest))], rank,
               spheres[i].center, reach[i]);
  }
  return levels;
}

}  // namespace

CellList::CellList(const SphereSet& spheres, std::span<const double> reach)
    : spheres_(spheres.size()), rank_(spheres.size()), id_(spheres.size()) {
  const std::vector<SphereId> order = canonical_order(spheres);
  std::uint32_t base = 0;
  for (const LevelMembers& members : split_by_reach(spheres, reach, order)) {
    if (members.ranks.empty()) continue;
    CellListView::Level level = shape_of(members);
    std::vector<std::uint32_t> cell_of(members.ranks.size());
    for (std::size_t m = 0; m < cell_of.size(); ++m) {
      cell_of[m] = cell_index(level, spheres[order[members.ranks[m]]].center);
    }
    const std::size_t cells = static_cast<std::size_t>(level.cells[0]) *
                              static_cast<std::size_t>(level.cells[1]) *
                              static_cast<std::size_t>(level.cells[2]);
    cell_start_.push_back(cell_starts(cell_of, cells, base));
    std::vector<std::uint32_t> next = cell_start_.back();
    for (std::size_t m = 0; m < cell_of.size(); ++m) {
      const std::uint32_t place = next[cell_of[m]]++;
      rank_[place] = members.ranks[m];
      id_[place] = order[members.ranks[m]];
      spheres_[place] = spheres[id_[place]];
    }
    base += static_cast<std::uint32_t>(cell_of.size());
    level.cell_start = cell_start_.back().data();
    view_.levels[view_.level_count++] = level;
  }
  view_.spheres = spheres_.data();
  view_.rank = rank_.data();
  view_.id = id_.data();
  view_.size = static_cast<std::uint32_t>(spheres_.size());
}

CellList make_ball_list(const SphereSet& spheres) {
  std::vector<double> reach(spheres.size());
  for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = spheres[i].radius;
  return CellList(spheres, reach);
}

}  // namespace vdwmesh
