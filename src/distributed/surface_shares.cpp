// Shares of a surface. Each rank samples the surface of some spheres (sample_surface()). The
// samples of all ranks, sorted by their bricks, are then cut into runs of equal area. The spheres
// near a run are chosen by z alone, because the keys of bricks rise with z first.
#include "distributed/surface_shares.hpp"

#include <algorithm>
#include <cmath>

#include "extract/area_estimate.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/brick_search.hpp"
#include "extract/bricks/brick.hpp"

namespace vdwmesh {
namespace {

// An interval of z, Å.
struct Slab {
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
Slab slab_of_bricks(double origin, double spacing, std::int64_t first, std::int64_t last) {
  const auto side = static_cast<double>(kBrickSide);
  return {origin + spacing * (side * static_cast<double>(first) - 2),
          origin + spacing * (side * static_cast<double>(last + 1) + 1)};
}

}  // namespace

std::vector<BrickArea> estimate_bricks(const SphereSet& spheres, const FieldModel& model,
                                       std::size_t part, std::size_t parts) {
  std::vector<BrickArea> areas;
  for (const SurfaceSample& sample : sample_surface(spheres, model, part, parts)) {
    areas.push_back({key_at(model.grid, sample.point), sample.area});
  }
  return areas;
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

ChosenSpheres spheres_near(const SphereSet& spheres, const FieldModel& model,
                           const KeyRange& range) {
  const GridSpec& grid = model.grid;
  const KeyRange halo = with_halo(range);
  const std::int64_t top = brick_count(grid.cells.z) - 1;
  const std::int64_t last = halo.end == kNoBrickKey ? top : brick_of_key(halo.end).z;
  const Slab slab =
      slab_of_bricks(grid.origin.z, grid.spacing, brick_of_key(halo.begin).z, std::min(last, top));
  ChosenSpheres near = choose(spheres, [&](SphereId, const Sphere& s) {
    const double reach = field_reach(model, s.radius) + grid.spacing;
    return s.center.z + reach >= slab.lower && s.center.z - reach <= slab.upper;
  });
  if (near.spheres.empty()) near = {{spheres[0]}, {0}};
  return near;
}

CellListFrame frame_together(const Ranks& ranks, const SphereSet& spheres,
                             const FieldModel& model) {
  CellListFrame frame;
  ranks.together([&] {
    if (ranks.is_first()) frame = make_field_frame(spheres, model);
  });
  frame.smallest_reach = ranks.shared(frame.smallest_reach);
  ranks.share(frame.levels);
  return frame;
}

}  // namespace vdwmesh
