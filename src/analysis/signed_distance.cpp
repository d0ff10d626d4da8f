// Measures points with a SurfaceFinder, block by block.
#include "analysis/signed_distance.hpp"

#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPerBlock = 2048;  // points

}  // namespace

std::vector<double> signed_distances(std::span<const Vec3d> points, const SphereSet& spheres,
                                     Monitor* monitor) {
  check_points(points, spheres, "point");
  const Box world = box_around(bounding_box(spheres), points);
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
