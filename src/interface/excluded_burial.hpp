// What two sides bury of each other's solvent-excluded surface, and the gap between them.
#pragma once

#include "core/monitor.hpp"
#include "excluded/excluded_measures.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct ExcludedBurial {
  double area_a, area_b, area_in_pair;  // Å² of each side alone and of both together
  // Å², by the atoms of each side: what their patches alone have more than in the pair. Their sum
  // is area_a + area_b - area_in_pair.
  double buried_a, buried_b;
  // Å³ that a probe enters beside each side alone and not beside the pair: the excluded solid of
  // the pair less those of the sides. Where the solids of the sides overlap, as in clashes and
  // hydrogen bonds, the overlap counts against it.
  double gap_volume;
};

// The complete surface of a side, or of a pair, with the shares of its atoms. `atoms` are without
// the probe (Å). The result does not depend on the number of threads. Throws as excluded_measures()
// does.
ExcludedSurface surface_of_side(const SphereSet& atoms, double probe, Monitor* monitor = nullptr);

// All three come from surface_of_side(), so that a side of several pairs is measured once. The
// atoms of the pair are those of a, then those of b.
ExcludedBurial excluded_burial(const ExcludedSurface& a, const ExcludedSurface& b,
                               const ExcludedSurface& pair);

}  // namespace vdwmesh
