// The check that every sphere of a SphereSet passes, for spheres that come in other arrays.
#pragma once

#include <cstddef>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Throws InvalidInput that names `index` if a SphereSet would not accept the sphere.
void check_sphere(const Sphere& sphere, std::size_t index);

}  // namespace vdwmesh
