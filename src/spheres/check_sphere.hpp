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

// Whether a number is a radius as users give it: finite and not negative, and above 0 with the
// probe, which may be negative.
VDWMESH_HD inline bool is_radius(double radius, double probe) {
  return radius >= 0 && radius <= kFarthestSphere && radius + probe > 0;
}

// The radius grown by the probe, Å. Throws InvalidInput that names element `index` of the array
// `name` unless is_radius().
double grown_radius(double radius, double probe, const char* name, std::size_t index);

}  // namespace vdwmesh
