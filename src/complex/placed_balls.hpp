// The balls of an arrangement, in an order that follows from their places.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct SpatialFrame;

// The balls of a SphereSet with distinct centres: of concentric balls only the largest, of equal
// balls only the one with the lowest id.
//
// They stand in the order of a SpatialFrame, in which balls near in space are near. It numbers the
// balls, and with them the arcs, corners and vertices of crease-exact meshes.
struct PlacedBalls {
  // All lengths are multiplied by 2^-scale_exponent, so that the largest radius is in [1/2, 1).
  std::vector<Sphere> balls;
  std::vector<SphereId> ids;  // for each ball its id in the SphereSet
  int scale_exponent = 0;
};

// The exponent for which 2^-exponent times the largest radius is in [1/2, 1). Throws InvalidInput
// for an empty set.
int scale_exponent(const SphereSet& spheres);

// The result depends on the spheres alone, and not on their order, except for their ids. With the
// frame and the exponent of a larger set, the balls have the order and the scale that they have
// there. Throws InvalidInput for an empty set or if the extent of the spheres overflows a double.
PlacedBalls placed_balls(const SphereSet& spheres);
PlacedBalls placed_balls(const SphereSet& spheres, const SpatialFrame& frame, int exponent);

// The corners of a tetrahedron around all balls, far outside of each of them. Throws InvalidInput
// if their coordinates would not be finite.
std::array<Vec3d, 4> auxiliary_points(const std::vector<Sphere>& balls);

}  // namespace vdwmesh
