// Compares a mesh with the exact union of the balls, as a whole and sphere by sphere, and counts
// the components of a union. Relative errors need the exact measures of all balls.
#include "analysis/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/blocks.hpp"
#include "core/disjoint_sets.hpp"
#include "core/sum.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

// Spheres that were not measured have NaN for an area.
bool measures_all(const ExactUnion& exact) {
  return std::ranges::none_of(exact.per_sphere,
                              [](const SphereMeasures& m) { return std::isnan(m.area); });
}

// Union-find over the spheres, by their list places. The cell list gives, for each ball, all balls
// near its bounding box; the ball is joined with every ball that it overlaps or touches. All
// threads join at the same time, which DisjointSets (lock-free union-find) allows.
DisjointSets joined_places(const CellListView& view) {
  DisjointSets pieces(view.size);
  for_all(view.size, [&](std::size_t i) {
    const Sphere& a = view.spheres[static_cast<ListPlace>(i)];
    const Vec3d reach{a.radius, a.radius, a.radius};
    visit_near_box(view, a.center - reach, a.center + reach, [&](ListPlace j) {
      const Sphere& b = view.spheres[j];
      if (norm(a.center - b.center) <= a.radius + b.radius) {
        pieces.join(static_cast<std::uint32_t>(i), to_index(j));
      }
      return false;  // false means: visit the next sphere
    });
  });
  return pieces;
}

}  // namespace

Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExactUnion& exact) {
  Comparison result;
  const bool all = measures_all(exact);
  constexpr double kNotComparable = std::numeric_limits<double>::quiet_NaN();
  result.area_relative_error = all ? (measures.area - exact.area) / exact.area : kNotComparable;
  if (all && measures.volume) {
    result.volume_relative_error = (*measures.volume - exact.volume) / exact.volume;
  }
  // The exact χ is the Euler characteristic of the boundary, which is twice the χ of the union; two
  // balls that touch in a point count there as one connected body. A mesh that is a 2-manifold
  // separates them, because it needs two vertices at the point. Each separation raises the χ of the
  // union by 1, and the χ of the boundary by 2.
  if (exact.topology && topology.closed && topology.manifold) {
    const auto doubled = 2 * static_cast<std::int64_t>(exact.topology->point_contacts);
    result.euler_characteristic_difference =
        topology.euler_characteristic - (exact.topology->euler_characteristic + doubled);
  }
  return result;
}

// Spheres that were not measured have NaN for an area, which is not at least anything.
std::optional<AreaErrors> area_errors(std::span<const double> mesh_areas,
                                      std::span<const SphereMeasures> exact, double least) {
  if (mesh_areas.size() != exact.size()) return std::nullopt;
  AreaErrors errors;
  WideSum squares;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double area = exact[i].area;
    if (!(area >= least)) continue;
    const double error = std::abs(mesh_areas[i] / area - 1);
    ++errors.spheres;
    squares.add(error * error);
    if (errors.worst != kNoSphere && !(error > errors.max)) continue;
    errors.max = error;
    errors.worst = static_cast<SphereId>(i);
  }
  if (errors.spheres == 0) return std::nullopt;
  errors.rms = std::sqrt(squares.value() / static_cast<double>(errors.spheres));
  return errors;
}

std::uint64_t count_components(const SphereSet& spheres) {
  const CellList list = make_ball_list(spheres);
  return joined_places(list.view()).count();
}

Buffer<std::uint32_t> connected_balls(const SphereSet& spheres) {
  const CellList list = make_ball_list(spheres);
  DisjointSets pieces = joined_places(list.view());
  Buffer<std::uint32_t> component(spheres.size());
  for_all(component.size(), [&](std::size_t i) {
    const auto place = static_cast<ListPlace>(i);
    component[list.view().id[place]] = pieces.find(to_index(place));
  });
  return component;
}

}  // namespace vdwmesh
