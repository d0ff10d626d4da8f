// excluded_burial(): differences of three excluded surfaces, by the shares of their atoms. Sums are
// wide, so that they do not depend on the order of the atoms.
#include "interface/excluded_burial.hpp"

#include <cstddef>

#include "core/sum.hpp"

namespace vdwmesh {

ExcludedSurface surface_of_side(const SphereSet& atoms, double probe, Monitor* monitor) {
  return excluded_measures(atoms,
                           {.probe = probe, .per_atom = true, .shells = false, .monitor = monitor})
      .complete;
}

ExcludedBurial excluded_burial(const ExcludedSurface& a, const ExcludedSurface& b,
                               const ExcludedSurface& pair) {
  const auto lost = [&](const ExcludedSurface& alone, std::size_t first) {
    WideSum sum;
    for (std::size_t i = 0; i < alone.per_atom.size(); ++i) {
      sum.add(alone.per_atom[i].area.sum());
      sum.add(-pair.per_atom[first + i].area.sum());
    }
    return sum.value();
  };
  return {.area_a = a.area,
          .area_b = b.area,
          .area_in_pair = pair.area,
          .buried_a = lost(a, 0),
          .buried_b = lost(b, a.per_atom.size()),
          .gap_volume = pair.volume - a.volume - b.volume};
}

}  // namespace vdwmesh
