#include "support/union_verdict.hpp"

#include <cmath>
#include <limits>

#include "support/curved_measures.hpp"

namespace vdwmesh::testing {

TopologyDifference topology_difference(const SphereSet& spheres, const reference::MeshFacts& mesh,
                                       const UnionTopology& exact) {
  const auto whole = [](auto number) { return static_cast<std::int64_t>(number); };
  const std::uint64_t components =
      exact.point_contacts > 0 ? open_components(spheres) : exact.components;
  return {
      mesh.euler_characteristic() - exact.euler_characteristic - 2 * whole(exact.point_contacts),
      whole(mesh.positive_shells) - whole(components),
      whole(mesh.negative_shells) - whole(exact.voids)};
}

MeasureDifference measure_difference(const SphereSet& spheres, const IndexedMesh& mesh,
                                     const reference::MeshFacts& facts, const ExactUnion& exact) {
  const CurvedMeasures found = curved_measures(spheres, mesh, facts.volume);
  double worst = 0;
  for (SphereId i = 0; i < spheres.size(); ++i) {
    const double r = spheres[i].radius;
    const double difference = std::abs(found.area[i] - exact.per_sphere[i].area) / (r * r);
    if (!(difference <= worst)) worst = difference;
    if (!std::isfinite(worst)) break;
  }
  return {worst, std::abs(found.volume / exact.volume - 1)};
}

}  // namespace vdwmesh::testing
