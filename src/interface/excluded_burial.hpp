// What two sides bury of each other's solvent-excluded surface, and the gap between them.
#pragma once

#include "core/monitor.hpp"
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

// `a` and `b` are the atoms of the sides, without the probe (Å). Each surface is the complete one
// of excluded_measures.hpp. The result does not depend on the number of threads. Throws as
// excluded_measures() does.
ExcludedBurial excluded_burial(const SphereSet& a, const SphereSet& b, double probe,
                               Monitor* monitor = nullptr);

}  // namespace vdwmesh
