// Compares a mesh with the exact excluded surface.
#include "excluded/excluded_comparison.hpp"

namespace vdwmesh {

Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExcludedSurface& exact) {
  Comparison result;
  result.area_relative_error = (measures.area - exact.area) / exact.area;
  if (measures.volume) {
    result.volume_relative_error = (*measures.volume - exact.volume) / exact.volume;
  }
  if (exact.topology && topology.closed && topology.manifold) {
    result.euler_characteristic_difference =
        topology.euler_characteristic - exact.topology->euler_characteristic;
  }
  return result;
}

}  // namespace vdwmesh
