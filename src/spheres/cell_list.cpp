// Builds a CellList in three steps, all of them on all cores: it sorts the spheres into the
// canonical order, chooses a level for each sphere by the octave of its reach, and sorts the
// spheres by level and cell. This last step is a counting sort that takes the spheres in canonical
// order and keeps their order, so that the spheres of a cell are in canonical order. It runs twice:
// over groups of consecutive cells (core/order/stable_groups.hpp), and within each group over its
// cells. The list is therefore the same for any number of threads.
#include "spheres/cell_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/bins.hpp"
#include "core/order/stable_groups.hpp"
#include "spheres/frame_fit.hpp"
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

// Whether a sphere fits its level of the frame.
bool takes(const CellListFrame& frame, const Sphere& s, double reach) {
  const auto level = static_cast<std::size_t>(level_of(reach, frame.smallest_reach));
  return level < frame.levels.size() && takes(frame.levels[level], s.center, reach);
}

void check_levels(const CellListFrame& frame) {
  if (frame.levels.size() <= CellListView::kMaxLevels) return;
  throw InvalidInput(fmt::format("the frame has {} levels, at most {} fit", frame.levels.size(),
                                 CellListView::kMaxLevels));
}

[[noreturn]] void throw_beyond_frame(std::size_t sphere) {
  throw InvalidInput(fmt::format(
      "sphere {}: lies beyond the cells of the given frame, or reaches farther than they allow: "
      "make the frame from all spheres that its lists will hold",
      sphere));
}

}  // namespace

void require_fit(const CellListFrame& frame, const SphereSet& spheres,
                 std::span<const double> reach) {
  check_levels(frame);
  const auto misfit = first_of_all(
      spheres.size(), [&](std::size_t i) { return !takes(frame, spheres[i], reach[i]); });
  if (misfit) throw_beyond_frame(*misfit);
}

CellListFrame frame_of(std::span<const LevelExtent> extents, double smallest_reach) {
  CellListFrame frame;
  frame.smallest_reach = smallest_reach;
  frame.levels.resize(extents.size());
  std::ranges::transform(extents, frame.levels.begin(), shape_of);
  while (frame.levels.back().cells[0] == 0) frame.levels.pop_back();
  return frame;
}

double least_of(std::span<const double> reach) {
  if (reach.empty()) return std::numeric_limits<double>::infinity();
  return join_blocks(
      reach.size(),
      [&](std::size_t first, std::size_t end) {
        return std::ranges::min(reach.subspan(first, end - first));
      },
      [](double& least, double part) { least = std::min(least, part); });
}

LevelExtents level_extents(const SphereSet& spheres, std::span<const double> reach,
                           double smallest_reach) {
  if (spheres.empty()) return {};
  const auto extents_of = [&](std::size_t first, std::size_t end) {
    LevelExtents extents;
    for (std::size_t i = first; i < end; ++i) {
      const auto level = static_cast<std::size_t>(level_of(reach[i], smallest_reach));
      extents[level].add(spheres[i].center, reach[i]);
    }
    return extents;
  };
  return join_blocks(spheres.size(), extents_of,
                     [](LevelExtents& total, const LevelExtents& part) { add(total, part); });
}

CellListFrame make_frame(const SphereSet& spheres, std::span<const double> reach) {
  if (spheres.empty()) return {};
  const double smallest = least_of(reach);
  return frame_of(level_extents(spheres, reach, smallest), smallest);
}

// How many spheres each level of the frame takes, and the first that does not fit the frame, or
// kNoSphere.
struct CellList::Members {
  std::array<std::size_t, CellListView::kMaxLevels> of_level{};
  SphereId misfit = kNoSphere;
};

// The cells of all levels that have spheres, numbered one level behind the other.
struct CellList::Layout {
  std::array<std::size_t, CellListView::kMaxLevels> first_cell{};  // by level of the frame
  std::size_t cells = 0;
};

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
  check_levels(frame);
  view_ = {};
  if (spheres.empty()) return;
  canonical_order(spheres, order_);
  const Members members = choose_levels(spheres, reach, frame);
  const Layout layout = lay_out(frame, members);
  find_cells(spheres, frame, layout);
  spheres_.resize(spheres.size());
  rank_.resize(spheres.size());
  id_.resize(spheres.size());
  cell_start_.resize(layout.cells + 1);
  sort_by_cell(spheres, layout.cells);
  view_.spheres = spheres_.data();
  view_.rank = rank_.data();
  view_.id = id_.data();
  view_.size = static_cast<std::uint32_t>(spheres.size());
}

// Fills level_of_rank_. Of several spheres that do not fit the frame, the one of the lowest rank is
// named.
CellList::Members CellList::choose_levels(const SphereSet& spheres, std::span<const double> reach,
                                          const CellListFrame& frame) {
  level_of_rank_.resize(order_.size());
  const auto choose = [&](std::size_t first, std::size_t end) {
    Members members{};
    for (std::size_t rank = first; rank < end; ++rank) {
      const SphereId i = order_[rank];
      const int level = level_of(reach[i], frame.smallest_reach);
      const auto number = static_cast<std::size_t>(level);
      level_of_rank_[rank] = static_cast<std::uint8_t>(level);
      ++members.of_level[number];
      if (members.misfit == kNoSphere && !takes(frame, spheres[i], reach[i])) members.misfit = i;
    }
    return members;
  };
  const Members all = join_blocks(order_.size(), choose, [](Members& total, const Members& part) {
    for (std::size_t level = 0; level < total.of_level.size(); ++level) {
      total.of_level[level] += part.of_level[level];
    }
    if (total.misfit == kNoSphere) total.misfit = part.misfit;
  });
  if (all.misfit != kNoSphere) throw_beyond_frame(all.misfit);
  return all;
}

// Puts the levels that have spheres into the view, and their cells one level behind the other.
// Levels without spheres are not in the view, so the level of the view may have a lower number than
// the level of the frame.
CellList::Layout CellList::lay_out(const CellListFrame& frame, const Members& members) {
  Layout layout;
  for (std::size_t number = 0; number < frame.levels.size(); ++number) {
    if (members.of_level[number] == 0) continue;
    static_cast<CellLevel&>(view_.levels[view_.level_count++]) = frame.levels[number];
    layout.first_cell[number] = layout.cells;
    layout.cells += cell_count(frame.levels[number]);
  }
  return layout;
}

void CellList::find_cells(const SphereSet& spheres, const CellListFrame& frame,
                          const Layout& layout) {
  cell_of_rank_.resize(order_.size());
  for_each_index(order_.size(), [&](std::size_t rank) {
    const std::size_t level = level_of_rank_[rank];
    const Vec3d& center = spheres[order_[rank]].center;
    cell_of_rank_[rank] = layout.first_cell[level] + cell_index(frame.levels[level], center);
  });
}

// Stores the spheres of all levels. Within a group of cells, the first loop counts the spheres of
// each cell, the second turns the counts into the ends of the cells, and the third stores the
// spheres from the last to the first, which turns the ends into the starts.
void CellList::sort_by_cell(const SphereSet& spheres, std::size_t cells) {
  const std::size_t wanted = usual_groups(order_.size());
  const auto shift = static_cast<unsigned>(std::bit_width((cells - 1) / wanted));
  const std::size_t groups = ((cells - 1) >> shift) + 1;
  ranks_.resize(order_.size());
  const std::vector<std::uint32_t> first = sort_into_groups(
      order_.size(), groups,
      [&](std::size_t rank) { return static_cast<std::size_t>(cell_of_rank_[rank] >> shift); },
      [&](std::size_t rank, std::uint32_t place) {
        ranks_[place] = static_cast<std::uint32_t>(rank);
      });
  const auto sort_group = [&](std::size_t group) {
    const std::size_t first_cell = group << shift, end_cell = std::min(cells, (group + 1) << shift);
    std::fill(&cell_start_[first_cell], &cell_start_[end_cell], 0u);
    for (std::size_t i = first[group]; i < first[group + 1]; ++i) {
      ++cell_start_[cell_of_rank_[ranks_[i]]];
    }
    std::uint32_t end = first[group];
    for (std::size_t cell = first_cell; cell < end_cell; ++cell) {
      end += cell_start_[cell];
      cell_start_[cell] = end;
    }
    for (std::size_t i = first[group + 1]; i-- > first[group];) {
      const std::uint32_t rank = ranks_[i], place = --cell_start_[cell_of_rank_[rank]];
      rank_[place] = Rank{rank};
      id_[place] = order_[rank];
      spheres_[place] = spheres[order_[rank]];
    }
  };
  constexpr std::size_t kGroupsPerBlock = 16;
  for_each_block(groups, kGroupsPerBlock, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t group = begin; group < end; ++group) sort_group(group);
  });
  cell_start_[cells] = static_cast<std::uint32_t>(order_.size());
  std::size_t next_cell = 0;
  for (int level = 0; level < view_.level_count; ++level) {
    view_.levels[level].cell_start = &cell_start_[next_cell];
    next_cell += cell_count(view_.levels[level]);
  }
}

CellList make_ball_list(const SphereSet& spheres) {
  std::vector<double> reach(spheres.size());
  for_each_index(reach.size(), [&](std::size_t i) { reach[i] = spheres[i].radius; });
  return CellList(spheres, reach);
}

}  // namespace vdwmesh
