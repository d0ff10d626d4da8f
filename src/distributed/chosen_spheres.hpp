// Some spheres of a set: what a rank keeps of the whole.
#pragma once

#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Spheres of a set, in their order there.
struct ChosenSpheres {
  Buffer<Sphere> spheres;
  std::vector<SphereId> ids;  // [i]: of spheres[i] in the whole set
};

// Fills `spheres` with the spheres of the set that have the ids.
inline void copy_spheres(const SphereSet& set, ChosenSpheres& chosen) {
  chosen.spheres.resize(chosen.ids.size());
  for_each_index(chosen.ids.size(), [&](std::size_t i) { chosen.spheres[i] = set[chosen.ids[i]]; });
}

// Chooses the spheres for which is_chosen(id, sphere) is true, which all cores ask in no particular
// order.
template <class IsChosen>
ChosenSpheres choose(const SphereSet& spheres, const IsChosen& is_chosen) {
  ChosenSpheres chosen;
  chosen.ids = collect<SphereId>(spheres.size(), [&](std::size_t i, std::vector<SphereId>& found) {
    const auto id = static_cast<SphereId>(i);
    if (is_chosen(id, spheres[i])) found.push_back(id);
  });
  copy_spheres(spheres, chosen);
  return chosen;
}

}  // namespace vdwmesh
