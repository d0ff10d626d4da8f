#include "analysis/comparison.hpp"

namespace vdwmesh {

Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExactUnion& exact) {
  Comparison result;
  result.area_relative_error = (measures.area - exact.area) / exact.area;
  if (measures.volume) {
    result.volume_relative_error = (*measures.volume - exact.volume) / exact.volume;
  }
  if (exact.topology && topology.closed && topology.manifold) {
    const auto doubled = 2 * static_cast<std::int64_t>(exact.topology->point_contacts);
    result.euler_characteristic_difference =
        topology.euler_characteristic - (exact.topology->euler_characteristic + doubled);
  }
  return result;
}

}  // namespace vdwmesh
