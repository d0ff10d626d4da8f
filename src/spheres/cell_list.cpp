// Builds a CellList in three steps: it sorts the spheres into the canonical order, chooses a level
// for each sphere by the octave of its reach, and sorts the spheres of each level by cell. This
// last step is a counting sort that takes the spheres in canonical order and keeps their order, so
// that the spheres of a cell are in canonical order.
#include "spheres/cell_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/bins.hpp"
#include "core/errors.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh {
namespace {

// A bound on the rounding errors of cell_range() and cell_index(), Å: sixteen units in the last
// place of the largest number that occurs in them, at most twice the largest coordinate or reach.
// cell_range() also widens every range by 1e-9 of a cell's width, but for small spheres far from
// the coordinate origin, rounding may exceed that.
double rounding_of(const LevelExtent& extent) {
  double largest = extent.reach;
  for (int axis = 0; axis < 3; ++axis) {
    largest = std::max(
        {largest, std::abs(extent.centers.lower[axis]), std::abs(extent.centers.upper[axis])});
  }
  return 16 * std::numeric_limits<double>::epsilon() * 2 * largest;
}

// The cells of a level. They are as wide as the largest reach, or wider if there would be more than
// 8 cells per sphere (but at least 4096 cells are allowed), so that the memory for cells stays in
// proportion to the memory for spheres. cubic_bins() chooses the width.
CellLevel shape_of(const LevelExtent& extent) {
  CellLevel level{};
  if (extent.spheres == 0) return level;
  level.origin = extent.centers.lower;
  level.reach = extent.reach + rounding_of(extent);
  const double most = std::max(4096.0, 8.0 * static_cast<double>(extent.spheres));
  const Bins bins = cubic_bins(extent.centers.upper - extent.centers.lower, extent.reach, most);
  level.cell_size = bins.width;
  std::ranges::copy(bins.count, level.cells);
  return level;
}

// Whether a sphere fits a level: its centre lies in a cell of the level, and its reach is at most
// the level's. Coordinates are never NaN, because SphereSet rejects NaN.
bool takes(const CellLevel& level, const Vec3d& center, double reach) {
  for (int axis = 0; axis < 3; ++axis) {
    const double offset = (center[axis] - level.origin[axis]) / level.cell_size;
    if (!(offset >= 0) || !(offset < level.cells[axis])) return false;
  }
  return reach <= level.reach;
}

[[noreturn]] void throw_beyond_frame(std::size_t sphere) {
  throw InvalidInput(fmt::format(
      "sphere {}: lies beyond the cells of the given frame, or reaches farther than they allow: "
      "make the frame from all spheres that its lists will hold",
      sphere));
}

}  // namespace

CellListFrame frame_of(std::span<const LevelExtent> extents, double smallest_reach) {
  CellListFrame frame;
  frame.smallest_reach = smallest_reach;
  frame.levels.resize(extents.size());
  std::ranges::transform(extents, frame.levels.begin(), shape_of);
  while (frame.levels.back().cells[0] == 0) frame.levels.pop_back();
  return frame;
}

CellListFrame make_frame(const SphereSet& spheres, std::span<const double> reach) {
  if (spheres.empty()) return {};
  const double smallest = *std::min_element(reach.begin(), reach.end());
  LevelExtent extents[CellListView::kMaxLevels];
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    extents[level_of(reach[i], smallest)].add(spheres[i].center, reach[i]);
  }
  return frame_of(extents, smallest);
}

CellList::CellList(const SphereSet& spheres, std::span<const double> reach) {
  rebuild(spheres, reach);
}

CellList::CellList(const SphereSet& spheres, std::span<const double> reach,
                   const CellListFrame& frame) {
  rebuild(spheres, reach, frame);
}

void CellList::rebuild(const SphereSet& spheres, std::span<const double> reach) {
  rebuild(spheres, reach, make_frame(spheres, reach));
}

void CellList::rebuild(const SphereSet& spheres, std::span<const double> reach,
                       const CellListFrame& frame) {
  if (frame.levels.size() > CellListView::kMaxLevels) {
    throw InvalidInput(fmt::format("the frame has {} levels, at most {} fit", frame.levels.size(),
                                   CellListView::kMaxLevels));
  }
  canonical_order(spheres, order_);
  std::size_t members[CellListView::kMaxLevels] = {};
  level_of_rank_.resize(order_.size());
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    const SphereId i = order_[rank];
    const int level = level_of(reach[i], frame.smallest_reach);
    const auto number = static_cast<std::size_t>(level);
    if (number >= frame.levels.size() || !takes(frame.levels[number], spheres[i].center, reach[i]))
      throw_beyond_frame(i);
    level_of_rank_[rank] = static_cast<std::uint8_t>(level);
    ++members[level];
  }
  spheres_.resize(spheres.size());
  rank_.resize(spheres.size());
  id_.resize(spheres.size());
  view_ = {spheres_.data(), rank_.data(), id_.data(), 0, 0, {}};
  for (std::size_t level = 0; level < frame.levels.size(); ++level) {
    if (members[level] > 0) add_level(spheres, frame.levels[level], level);
  }
}

// Appends the spheres of level `number` of the frame to the list by a counting sort: the first loop
// counts the spheres of each cell, the prefix sum turns the counts into list places, and the second
// loop stores the spheres. Levels without spheres are not in the view, so the level of the view may
// have a lower number than the level of the frame.
void CellList::add_level(const SphereSet& spheres, const CellLevel& level, std::size_t number) {
  const auto next_level = static_cast<std::size_t>(view_.level_count);
  if (cell_start_.size() == next_level) cell_start_.emplace_back();
  std::vector<std::uint32_t>& start = cell_start_[next_level];
  start.assign(cell_count(level) + 1, 0);
  start[0] = view_.size;
  cell_of_.clear();
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    if (level_of_rank_[rank] != number) continue;
    cell_of_.push_back(cell_index(level, spheres[order_[rank]].center));
    ++start[cell_of_.back() + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  next_ = start;
  std::size_t member = 0;
  for (std::size_t rank = 0; rank < order_.size(); ++rank) {
    if (level_of_rank_[rank] != number) continue;
    const std::uint32_t place = next_[cell_of_[member++]]++;
    rank_[place] = static_cast<std::uint32_t>(rank);
    id_[place] = order_[rank];
    spheres_[place] = spheres[order_[rank]];
  }
  view_.size += static_cast<std::uint32_t>(cell_of_.size());
  CellListView::Level& made = view_.levels[view_.level_count++];
  static_cast<CellLevel&>(made) = level;
  made.cell_start = start.data();
}

CellList make_ball_list(const SphereSet& spheres) {
  std::vector<double> reach(spheres.size());
  for (std::size_t i = 0; i < reach.size(); ++i) reach[i] = spheres[i].radius;
  return CellList(spheres, reach);
}

}  // namespace vdwmesh
