// Which spheres each rank measures, and which it needs for that.
#pragma once

#include <cstddef>
#include <vector>

#include "distributed/chosen_spheres.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct SphereShare {
  ChosenSpheres near;         // the share, and all spheres that overlap or touch one of it
  std::vector<SphereId> own;  // the share, as indices of near.spheres, ascending
};

// The part with number `part` of `parts`. The parts have equal numbers of spheres, but for one, and
// together they are all spheres. They lie one behind the other along the longest axis of the set,
// so that few spheres are near to two parts. A part is empty if there are fewer spheres than parts.
// Precondition: the set is not empty.
SphereShare share_of_spheres(const SphereSet& spheres, std::size_t part, std::size_t parts);

}  // namespace vdwmesh
