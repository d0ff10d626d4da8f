// GrownAtoms: adds the probe to the radii, triangulates, and places the accessible surface.
#include "excluded/probes/grown_atoms.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.hpp"

namespace vdwmesh::excluded {

SphereSet grown_by(const SphereSet& atoms, double probe) {
  if (!(probe > 0 && std::isfinite(probe))) {
    throw InvalidInput(fmt::format("the probe's radius is {}; it must be above 0", probe));
  }
  return grown(atoms.spheres(), probe);
}

GrownAtoms::GrownAtoms(const SphereSet& atoms, double probe, Monitor* monitor, double no_length)
    : triangulation(triangulate(grown_by(atoms, probe), monitor)),
      exponent(triangulation.scale_exponent),
      complex(dual_complex(triangulation, monitor)),
      shapes(triangulation, complex),
      surface(triangulation, complex, shapes, std::ldexp(probe, -exponent), no_length, monitor) {
  for (const SphereId id : triangulation.ids) {
    radius.push_back(std::ldexp(atoms[id].radius, -exponent));
  }
}

}  // namespace vdwmesh::excluded
