// The checks of limits that run before memory is taken. Each message says how much is needed, how
// much is allowed, and which spacing would fit, so that a user can act on it.
#include "extract/limits.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// A spacing, Å, at which the need would fall to the limit. Vertices, triangles and bytes are
// proportional to 1 / spacing², like the number of grid edges that a surface of given area crosses.
// The factor 1.02 covers the rounding of the spacing to three digits in the message, and deviations
// from this law.
double fitting_spacing(double spacing, std::uint64_t need, std::uint64_t limit) {
  return spacing * std::sqrt(static_cast<double>(need) / static_cast<double>(limit)) * 1.02;
}

}  // namespace

void check_mesh_limits(const MeshDemand& d, std::uint64_t memory_limit) {
  if (d.size.vertices > kMaxVertices) {
    throw LimitExceeded(fmt::format(
        "{} vertices; a mesh holds at most {}: choose a spacing of at least {:.3g} Å",
        d.size.vertices, kMaxVertices, fitting_spacing(d.spacing, d.size.vertices, kMaxVertices)));
  }
  if (d.arrays.connectivity == Connectivity::half_edges && 3 * d.size.triangles > kMaxHalfEdges) {
    throw LimitExceeded(fmt::format(
        "{} half-edges; at most {} can be numbered: choose a spacing of at least {:.3g} Å",
        3 * d.size.triangles, kMaxHalfEdges,
        fitting_spacing(d.spacing, 3 * d.size.triangles, kMaxHalfEdges)));
  }
  const std::uint64_t need = indexed_mesh_bytes(d.size, d.arrays) + d.scratch_bytes;
  if (need > memory_limit) {
    throw LimitExceeded(fmt::format(
        "{} vertices and {} triangles need {} bytes, {} are allowed: choose a spacing of at least "
        "{:.3g} Å or a higher memory limit",
        d.size.vertices, d.size.triangles, need, memory_limit,
        fitting_spacing(d.spacing, need, memory_limit)));
  }
}

void check_sampled(const SampledFieldView& field) {
  check(field.grid);
  if (!std::isfinite(field.isovalue)) {
    throw InvalidInput(fmt::format("isovalue {}: must be finite", field.isovalue));
  }
}

}  // namespace vdwmesh
