// How much surface a set of balls has, before anything is made of it.
#pragma once

#include "extract/sphere_set.hpp"

namespace vdwmesh {

// Area of the boundary of the union, Å², from points on a sample of the spheres: to 3 % for sets of
// thousands, to 10 % for less. For limits, not for reports. Always the same for the same set.
double estimate_area(const SphereSet& spheres);

}  // namespace vdwmesh
