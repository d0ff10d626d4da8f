// The check that every sphere of a SphereSet passes, for spheres that come in other arrays.
#pragma once

#include <cstddef>

#include "core/host_device.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Whether coordinates and radius are within their bounds; not if one is NaN.
VDWMESH_HD inline bool is_sphere(const Sphere& s) {
  const auto is_near = [](double x) { return -kFarthestSphere <= x && x <= kFarthestSphere; };
  return is_near(s.center.x) && is_near(s.center.y) && is_near(s.center.z) && s.radius > 0 &&
         s.radius <= kFarthestSphere;
}

// Throws InvalidInput that names `index` if a SphereSet would not accept the sphere.
void check_sphere(const Sphere& sphere, std::size_t index);

}  // namespace vdwmesh
