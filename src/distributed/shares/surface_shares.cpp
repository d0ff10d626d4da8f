// Shares of a surface. Each rank samples the surface of some spheres (sample_surface()). The
// samples of all ranks, sorted by their bricks, are then cut into runs of equal area. The spheres
// near a run are chosen by z alone, because the keys of bricks rise with z first.
//
// No rank looks at all spheres. Each looks at a block of them, joins what it finds with the others,
// and tells each rank which spheres of its block are near that rank's sample or run.
#include "distributed/shares/surface_shares.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/fixed_blocks.hpp"
#include "extract/area_estimate.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/brick_search.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/field_list.hpp"
#include "spheres/box.hpp"
#include "spheres/level_extent.hpp"

namespace vdwmesh {
namespace {

// How many groups of bricks a rank tells the first one of, which sorts those of all ranks while the
// others wait. A cut is off by 1 / 512 of a rank's share at most, less than the estimate is.
constexpr std::size_t kGroups = 512;

// An interval of z, Å.
struct LayerSlab {
  double lower, upper;
};

// Index of the brick that holds a coordinate, along one axis. Samples may lie beyond the grid.
std::int32_t brick_along(double origin, double spacing, std::int64_t cells, double x) {
  const double lattice = (x - origin) / spacing + 1;
  const double last = static_cast<double>(brick_count(cells)) - 1;
  return static_cast<std::int32_t>(std::clamp(std::floor(lattice / kBrickSide), 0.0, last));
}

std::uint64_t key_at(const GridSpec& grid, const Vec3d& p) {
  return brick_key({brick_along(grid.origin.x, grid.spacing, grid.cells.x, p.x),
                    brick_along(grid.origin.y, grid.spacing, grid.cells.y, p.y),
                    brick_along(grid.origin.z, grid.spacing, grid.cells.z, p.z)});
}

// The interval along an axis that holds the nodes of bricks first to last, with a spacing on either
// side, which is more than coordinates are rounded by.
LayerSlab slab_of_bricks(double origin, double spacing, std::int64_t first, std::int64_t last) {
  const auto side = static_cast<double>(kBrickSide);
  return {origin + spacing * (side * static_cast<double>(first) - 2),
          origin + spacing * (side * static_cast<double>(last + 1) + 1)};
}

// The spheres of one of `blocks` blocks, of about equal numbers.
std::span<const Sphere> block_of(const SphereSet& spheres, std::size_t block, std::size_t blocks) {
  const std::size_t first = begin_of_part(spheres.size(), block, blocks),
                    end = begin_of_part(spheres.size(), block + 1, blocks);
  return spheres.spheres().subspan(first, end - first);
}

std::span<const Sphere> own_block(const Ranks& ranks, const SphereSet& spheres) {
  return block_of(spheres, static_cast<std::size_t>(ranks.number()),
                  static_cast<std::size_t>(ranks.count()));
}

// bounding_box() and center_bounding_box(), by one look at each sphere.
struct Boxes {
  Box balls = empty_box(), centers = empty_box();

  void add(const Boxes& other) {
    include(balls, other.balls);
    include(centers, other.centers);
  }
};

Boxes boxes_of(std::span<const Sphere> spheres) {
  if (spheres.empty()) return {};
  return join_blocks(
      spheres.size(),
      [&](std::size_t begin, std::size_t end) {
        Boxes boxes;
        for (const Sphere& s : spheres.subspan(begin, end - begin)) {
          boxes.add({box_of(s), box_of({s.center, 0})});
        }
        return boxes;
      },
      [](Boxes& all, const Boxes& boxes) { all.add(boxes); });
}

// What all ranks have found for this one, each among its own spheres: ascending. Collective.
template <class Found>
std::vector<Found> found_for_own(const Ranks& ranks,
                                 const std::vector<std::vector<Found>>& for_each_rank) {
  return joined(ranks.exchange(for_each_rank));
}

// The spheres that have an effect on a run of bricks are within a slab. Both ends of the slabs rise
// from run to run.
std::vector<LayerSlab> slabs_of_runs(const GridSpec& grid, std::span<const std::uint64_t> begins,
                                     HaloCounts halo) {
  const std::int64_t top = brick_count(grid.cells.z) - 1;
  std::vector<LayerSlab> slabs;
  for (std::size_t run = 0; run < begins.size(); ++run) {
    const KeyRange own = run_at(begins, run);
    const KeyRange counted =
        halo == HaloCounts::given ? own : with_halo(own, Connectivity::triangles);
    const std::int64_t last = counted.end == kNoBrickKey ? top : brick_of_key(counted.end).z;
    slabs.push_back(slab_of_bricks(grid.origin.z, grid.spacing, brick_of_key(counted.begin).z,
                                   std::min(last, top)));
  }
  return slabs;
}

}  // namespace

GridSpec grid_together(const Ranks& ranks, const SphereSet& spheres, const GridOptions& options) {
  Boxes own;
  const bool looks = ranks.count() > 1 && !options.given;
  ranks.together([&] {
    if (looks) own = boxes_of(own_block(ranks, spheres));
  });
  Boxes all;
  if (looks) {
    for (const Boxes& boxes : ranks.of_all(own)) all.add(boxes);
  }
  GridSpec grid{};
  ranks.together([&] {
    grid = looks && !spheres.empty() ? make_grid(all.balls, all.centers, options)
                                     : make_grid(spheres, options);
  });
  return grid;
}

CellListFrame frame_together(const Ranks& ranks, const SphereSet& spheres,
                             const FieldModel& model) {
  SphereSet block;
  Buffer<double> reaches;
  ranks.together([&] {
    block = SphereSet::view(own_block(ranks, spheres));
    reaches = field_reaches(block, model);
  });
  const double smallest = std::ranges::min(ranks.of_all(least_of(reaches)));
  LevelExtents own;
  ranks.together([&] { own = level_extents(block, reaches, smallest); });
  LevelExtents all;
  for (const LevelExtents& extents : ranks.of_all(own)) add(all, extents);
  CellListFrame frame;
  ranks.together([&] {
    if (!spheres.empty()) frame = frame_of(all, smallest);
  });
  return frame;
}

std::vector<std::uint64_t> cut_bricks(std::vector<BrickArea> areas, std::size_t count) {
  std::ranges::sort(areas, {}, &BrickArea::key);
  double whole = 0;
  for (const BrickArea& a : areas) whole += a.area;
  std::vector<std::uint64_t> begins{0};
  double before = 0;
  for (std::size_t i = 0; i < areas.size() && begins.size() < count; ++i) {
    const double wanted = whole * static_cast<double>(begins.size()) / static_cast<double>(count);
    // A run may begin only where a brick does.
    const bool begins_brick = i > 0 && areas[i].key != areas[i - 1].key;
    if (begins_brick && before >= wanted) begins.push_back(areas[i].key);
    before += areas[i].area;
  }
  begins.resize(count, kNoBrickKey);
  return begins;
}

std::vector<BrickArea> join_bricks(std::vector<BrickArea> areas, std::size_t count) {
  std::ranges::sort(areas, {}, &BrickArea::key);
  double whole = 0;
  for (const BrickArea& a : areas) whole += a.area;
  const double least = whole / static_cast<double>(count);  // of all groups but the last
  std::vector<BrickArea> groups;
  for (const BrickArea& a : areas) {
    if (groups.empty() || groups.back().area >= least) {
      groups.push_back(a);
    } else {
      groups.back().area += a.area;
    }
  }
  return groups;
}

std::vector<std::uint64_t> share_bricks(const Ranks& ranks, const SphereSet& spheres,
                                        const FieldModel& model) {
  const auto rank = static_cast<std::size_t>(ranks.number());
  const auto count = static_cast<std::size_t>(ranks.count());
  std::vector<std::vector<SphereId>> for_each;
  ranks.together([&] { for_each = spheres_near_samples(spheres, model, rank, count); });
  const std::vector<SphereId> near = found_for_own(ranks, for_each);
  std::vector<BrickArea> areas;
  ranks.together([&] {
    for (const SurfaceSample& sample : sample_surface(spheres, model, rank, count, near)) {
      areas.push_back({key_at(model.grid, sample.point), sample.area});
    }
    areas = join_bricks(std::move(areas), kGroups);
  });
  std::vector<BrickArea> all = ranks.collect(std::span<const BrickArea>(areas));
  std::vector<std::uint64_t> begins;
  ranks.together([&] {
    if (ranks.is_first()) begins = cut_bricks(std::move(all), count);
  });
  ranks.share(begins);
  return begins;
}

KeyRange run_at(std::span<const std::uint64_t> begins, std::size_t run) {
  return {begins[run], run + 1 < begins.size() ? begins[run + 1] : kNoBrickKey};
}

KeyRange run_of(const Ranks& ranks, std::span<const std::uint64_t> begins) {
  return run_at(begins, static_cast<std::size_t>(ranks.number()));
}

std::vector<std::vector<SphereRun>> spheres_near_runs(const SphereSet& spheres,
                                                      const FieldModel& model, std::size_t block,
                                                      std::span<const std::uint64_t> begins,
                                                      HaloCounts halo) {
  using Near = std::vector<std::vector<SphereRun>>;  // by run of bricks
  const std::vector<LayerSlab> slabs = slabs_of_runs(model.grid, begins, halo);
  const std::span<const Sphere> looked_at = block_of(spheres, block, begins.size());
  if (looked_at.empty()) return Near(begins.size());
  const auto first_id = static_cast<SphereId>(looked_at.data() - spheres.spheres().data());
  return join_blocks(
      looked_at.size(),
      [&](std::size_t begin, std::size_t end) {
        Near near(slabs.size());
        for (std::size_t i = begin; i < end; ++i) {
          const double reach = field_reach(model, looked_at[i].radius) + model.grid.spacing;
          const double z = looked_at[i].center.z;
          auto run = static_cast<std::size_t>(
              std::ranges::lower_bound(slabs, z - reach, {}, &LayerSlab::upper) - slabs.begin());
          for (; run < slabs.size() && slabs[run].lower <= z + reach; ++run) {
            add_id(first_id + static_cast<SphereId>(i), near[run]);
          }
        }
        return near;
      },
      append_to_each<SphereRun>);
}

ChosenSpheres spheres_near(const Ranks& ranks, const SphereSet& spheres, const FieldModel& model,
                           std::span<const std::uint64_t> begins, HaloCounts halo) {
  const auto rank = static_cast<std::size_t>(ranks.number());
  std::vector<std::vector<SphereRun>> for_each;
  ranks.together([&] { for_each = spheres_near_runs(spheres, model, rank, begins, halo); });
  const std::vector<SphereRun> runs = found_for_own(ranks, for_each);
  ChosenSpheres near;
  ranks.together([&] {
    near.ids = ids_of(runs);
    if (near.ids.empty()) near.ids = {0};
    copy_spheres(spheres, near);
  });
  return near;
}

}  // namespace vdwmesh
