// Tells a spacing that is too wide from an isovalue that no node reaches, and names what would do.
#include "steps/grid_checks.hpp"

#include <algorithm>

#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// The radius of the smallest ball, as a spacing that would do: a ball is certain to hold a grid
// node if the spacing is at most 2/√3 of its radius.
double smallest_radius(const SphereSet& spheres) {
  const auto by_radius = [](const Sphere& a, const Sphere& b) { return a.radius < b.radius; };
  return std::ranges::min_element(spheres.spheres(), by_radius)->radius;
}

[[noreturn]] void throw_too_coarse(double spacing, const SphereSet& spheres) {
  refuse("--spacing {}: too coarse, no grid node lies inside the surface; try --spacing {:.2g}",
         spacing, smallest_radius(spheres));
}

}  // namespace

// With a spacing larger than the molecule, a node may lie inside by chance, but the mesh around it
// would not resemble the surface. If the spacing is so large that the coordinates vanish beside it,
// there are not even different nodes.
void require_sensible_spacing(const SphereSet& spheres, double spacing) {
  const Box box = bounding_box(spheres);
  const Vec3d size = box.upper - box.lower;
  if (spacing > std::max({size.x, size.y, size.z})) throw_too_coarse(spacing, spheres);
}

// If the grid is fine enough for the smallest ball and a blended field still has no node inside,
// the isovalue is too high.
void require_triangles(std::uint64_t triangles, const SphereSet& spheres, double spacing,
                       const std::optional<double>& isovalue) {
  if (triangles > 0) return;
  if (!isovalue || spacing > smallest_radius(spheres)) throw_too_coarse(spacing, spheres);
  refuse("--isovalue {}: the field reaches it at no grid node; try a lower one", *isovalue);
}

}  // namespace vdwmesh::apps
