// Some spheres of a set: what a rank keeps of the whole.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Spheres of a set, in their order there.
struct ChosenSpheres {
  std::vector<Sphere> spheres;
  std::vector<SphereId> ids;  // [i]: of spheres[i] in the whole set
};

// Chooses the spheres for which is_chosen(id, sphere) is true. It is called once for each sphere,
// in their order.
template <class IsChosen>
ChosenSpheres choose(const SphereSet& spheres, const IsChosen& is_chosen) {
  ChosenSpheres chosen;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const auto id = static_cast<SphereId>(i);
    if (!is_chosen(id, spheres[i])) continue;
    chosen.spheres.push_back(spheres[i]);
    chosen.ids.push_back(id);
  }
  return chosen;
}

}  // namespace vdwmesh
