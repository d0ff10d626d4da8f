// Measures points with a SurfaceFinder, block by block.
#include "analysis/signed_distance.hpp"

#include <fmt/format.h>

#include <cmath>

#include "analysis/exposed_surface.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPerBlock = 2048;  // points

void check_points(std::span<const Vec3d> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw InvalidInput(fmt::format("point {} is not finite", i));
    }
  }
}

}  // namespace

std::vector<double> signed_distances(std::span<const Vec3d> points, const SphereSet& spheres,
                                     Monitor* monitor) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no boundary");
  check_points(points);
  Box world = bounding_box(spheres);
  for (const Vec3d& p : points) include(world, p);
  const ExposedSurface surface(spheres, monitor);
  const SurfaceFinder finder(surface, world);
  std::vector<double> found(points.size());
  begin_stage(monitor, "signed distances", block_count(points.size(), kPerBlock));
  const auto measure = [&](std::size_t, std::size_t first, std::size_t end) {
    finder.find(points.subspan(first, end - first), found.data() + first);
  };
  for_each_block(points.size(), kPerBlock, measure, monitor);
  return found;
}

}  // namespace vdwmesh
