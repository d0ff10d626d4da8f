// Atoms grown by the probe, with everything that the excluded surface is made of: triangulation,
// dual complex and accessible surface. Lengths are divided by 2^exponent, which is exact.
#pragma once

#include <vector>

#include "complex/boundary/boundary_shapes.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

// The atoms with the probe's radius (Å) added to theirs. Throws InvalidInput unless the probe is
// above 0 and finite.
SphereSet grown_by(const SphereSet& atoms, double probe);

struct GrownAtoms {
  // Arcs up to a (scaled) length of `no_length` are points. Throws as excluded_measures() does.
  GrownAtoms(const SphereSet& atoms, double probe, Monitor* monitor, double no_length = kNoLength);
  GrownAtoms(const GrownAtoms&) = delete;  // `surface` looks at the other members

  const PowerTriangulation triangulation;
  const int exponent;
  const DualComplex complex;
  const BoundaryShapes shapes;
  const AccessibleSurface surface;
  std::vector<double> radius;  // by ball of the triangulation, without the probe
};

}  // namespace vdwmesh::excluded
