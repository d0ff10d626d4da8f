// excluded_burial(): three excluded surfaces, with the shares of their atoms. Sums are wide, so
// that they do not depend on the order of the atoms.
#include "interface/excluded_burial.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "core/sum.hpp"
#include "excluded/excluded_measures.hpp"

namespace vdwmesh {

ExcludedBurial excluded_burial(const SphereSet& a, const SphereSet& b, double probe,
                               Monitor* monitor) {
  std::vector<Sphere> both;
  both.reserve(a.size() + b.size());
  for (const SphereSet* side : {&a, &b})
    for (std::size_t i = 0; i < side->size(); ++i)
      both.push_back((*side)[static_cast<SphereId>(i)]);
  const auto measure = [&](const SphereSet& atoms) {
    return excluded_measures(
               atoms, {.probe = probe, .per_atom = true, .shells = false, .monitor = monitor})
        .complete;
  };
  const ExcludedSurface of_a = measure(a), of_b = measure(b);
  const ExcludedSurface pair = measure(SphereSet(std::move(both)));
  const auto lost = [&](const ExcludedSurface& alone, std::size_t first) {
    WideSum sum;
    for (std::size_t i = 0; i < alone.per_atom.size(); ++i) {
      sum.add(alone.per_atom[i].area.sum());
      sum.add(-pair.per_atom[first + i].area.sum());
    }
    return sum.value();
  };
  return {.area_a = of_a.area,
          .area_b = of_b.area,
          .area_in_pair = pair.area,
          .buried_a = lost(of_a, 0),
          .buried_b = lost(of_b, a.size()),
          .gap_volume = pair.volume - of_a.volume - of_b.volume};
}

}  // namespace vdwmesh
