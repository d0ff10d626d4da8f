// Signed distances from points to the exact boundary of a union of balls.
#pragma once

#include <span>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;

// Returns the distance of each point to the boundary of the union, Å: positive outside the union,
// negative inside. The distance is to the nearest exposed point, exact up to rounding
// (distances.hpp says what exposed means). Throws InvalidInput if there are no spheres or if a
// coordinate is not finite, and Cancelled on request of the monitor. The result does not depend on
// the number of threads.
std::vector<double> signed_distances(std::span<const Vec3d> points, const SphereSet& spheres,
                                     Monitor* monitor = nullptr);

}  // namespace vdwmesh
