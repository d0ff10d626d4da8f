// Octree descent to the bricks that the surface may cross. candidate_bricks() starts with one block
// that holds all bricks, splits every block into eight, and keeps those that meet the range and may
// hold surface (blended/block_bounds.hpp), until blocks are single bricks. The blocks of one level
// are tested in parallel. Their number is checked against the limit before they are stored, so a
// run that would not fit ends early, with a message that names a spacing that would fit. A block is
// stored as the brick_key() of its index among the blocks of its level.
#include "extract/brick_search.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/lanes/multiversion.hpp"
#include "core/monitor.hpp"
#include "extract/blended/block_bounds.hpp"

namespace vdwmesh {
namespace {

constexpr int kChildren = 8;

// The c-th of the eight half-size blocks of block b, as an index among the blocks one level below.
BrickIndex child(const BrickIndex& b, int c) {
  return {2 * b.x + (c & 1), 2 * b.y + (c >> 1 & 1), 2 * b.z + (c >> 2)};
}

// surviving_children() for the last level of a union of balls: the cell list is searched once for
// all bricks of the block `parent`. `near` is scratch memory for the list places of the balls
// that touch the block.
inline std::uint8_t surviving_bricks(const CellListView& list, const GridSpec& grid,
                                     const BrickIndex& parent, std::uint32_t wanted,
                                     std::vector<ListPlace>& near) {
  const BlockBox whole = block_box(grid, lattice_block(parent, 1));
  near.clear();
  if (whole.empty) return 0;
  visit_near_box(list, whole.lower, whole.upper, [&](ListPlace place) {
    const Sphere& ball = list.spheres[place];
    if (square_range(whole, ball.center).least <= ball.radius * ball.radius) near.push_back(place);
    return false;
  });
  std::uint32_t survivors = 0;
  for (int c = 0; c < kChildren; ++c) {
    if ((wanted >> c & 1) == 0) continue;
    const BlockBox box = block_box(grid, lattice_block(child(parent, c), 0));
    const bool may = !box.empty && union_may_cross(list, box, [&](auto&& visit) {
      for (const ListPlace place : near) {
        if (visit(place)) return;
      }
    });
    if (may) survivors |= 1u << c;
  }
  return static_cast<std::uint8_t>(survivors);
}

// Bit c is set if child c of the block `parent` may hold surface and has its bit in `wanted`.
// `level` is the level of `parent`, 1 or more.
VDWMESH_MULTIVERSION std::uint8_t surviving_children(const CellListView& list,
                                                     const FieldModel& model,
                                                     const BrickIndex& parent, int level,
                                                     std::uint32_t wanted,
                                                     std::vector<ListPlace>& near) {
  if (level == 1 && model.kind == FieldKind::vdw)
    return surviving_bricks(list, model.grid, parent, wanted, near);
  std::uint32_t survivors = 0;
  for (int c = 0; c < kChildren; ++c) {
    if ((wanted >> c & 1) == 0) continue;
    const LatticeBlock block = lattice_block(child(parent, c), level - 1);
    if (may_hold_surface(list, model, block)) survivors |= 1u << c;
  }
  return static_cast<std::uint8_t>(survivors);
}

// Returns the children of all `parents`, blocks of this level, that may hold surface and may have
// bricks in the range.
std::vector<std::uint64_t> descend(const CellListView& list, const FieldModel& model,
                                   const std::vector<std::uint64_t>& parents, int level,
                                   const KeyRange& range, std::uint64_t most) {
  std::vector<std::uint8_t> survivors(parents.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, parents.size(), 16), [&](const auto& task) {
    std::vector<ListPlace> near;
    for (std::size_t i = task.begin(); i < task.end(); ++i) {
      const BrickIndex parent = brick_of_key(parents[i]);
      std::uint32_t wanted = 0;
      for (int c = 0; c < kChildren; ++c) {
        if (block_meets(range, child(parent, c), level - 1)) wanted |= 1u << c;
      }
      survivors[i] = surviving_children(list, model, parent, level, wanted, near);
    }
  });
  std::uint64_t count = 0;
  for (const std::uint8_t s : survivors) count += static_cast<std::uint64_t>(std::popcount(s));
  if (count > most) {
    // The children have level - 1 levels below them, and each quadruples the blocks that a surface
    // crosses, so `bricks` estimates the final number. Halving the spacing quadruples it too, so
    // the fitting spacing grows with the square root of the excess.
    const double bricks = std::ldexp(static_cast<double>(count), 2 * (level - 1));
    const double fitting =
        model.grid.spacing *
        std::sqrt(bricks / static_cast<double>(std::max<std::uint64_t>(most, 1)));
    throw LimitExceeded(fmt::format(
        "the surface crosses about {:.3g} bricks of 8 x 8 x 8 nodes; at most {} fit in the memory "
        "allowed: choose a spacing of at least {:.3g} Å or a higher memory limit",
        bricks, most, 1.05 * fitting));
  }
  std::vector<std::uint64_t> children;
  children.reserve(count);
  for (std::size_t i = 0; i < parents.size(); ++i) {
    for (int c = 0; c < kChildren; ++c) {
      if (survivors[i] >> c & 1) children.push_back(brick_key(child(brick_of_key(parents[i]), c)));
    }
  }
  return children;
}

}  // namespace

KeyRange with_halo(const KeyRange& range, Connectivity connectivity) {
  const std::uint64_t below = connectivity == Connectivity::half_edges ? brick_key({0, 0, 1}) : 0,
                      above = brick_key({1, 1, 1});
  return {range.begin > below ? range.begin - below : 0,
          range.end < kNoBrickKey - above ? range.end + above : kNoBrickKey};
}

// The upper neighbour with the highest key is the one beyond the upper corner.
std::uint64_t first_with_border(const KeyRange& range) {
  if (range.end == kNoBrickKey) return kNoBrickKey;
  const std::uint64_t farthest = brick_key({1, 1, 1});
  return std::max(range.begin, range.end > farthest ? range.end - farthest : 0);
}

std::vector<std::uint64_t> candidate_bricks(const CellListView& list, const FieldModel& model,
                                            const KeyRange& range, std::uint64_t most,
                                            Monitor* monitor) {
  const Vec3i& cells = model.grid.cells;
  const auto widest = static_cast<std::uint32_t>(
      std::max({brick_count(cells.x), brick_count(cells.y), brick_count(cells.z)}));
  const int levels = static_cast<int>(std::bit_width(widest - 1));
  begin_stage(monitor, "search", static_cast<std::uint64_t>(levels) + 1);
  // The descent starts one level above the smallest block that holds all bricks. descend() tests
  // children only, so this block is tested too; without it a single brick would not be.
  std::vector<std::uint64_t> blocks{0};
  for (int level = levels + 1; level > 0; --level) {
    blocks = descend(list, model, blocks, level, range, most);
    advance(monitor, 1);
  }
  tbb::parallel_sort(blocks.begin(), blocks.end());
  return blocks;
}

}  // namespace vdwmesh
