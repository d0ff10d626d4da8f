// Clearance: the distance of a place from the nearest of some balls, negative inside of it. For the
// library's own use.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

double clearance_at(const std::vector<Sphere>& balls, const Vec3d& place);

struct ClearPlace {
  Vec3d place;
  double clearance;
};

// The local maximum of the clearance to which it rises from `start`, on a way on which it never
// falls, or the first place on that way where it reaches the ceiling; nothing if it rises without
// end. `trail`, if given, gets the places of the way, from the start to the end.
std::optional<ClearPlace> climb_clearance(const std::vector<Sphere>& balls, const Vec3d& start,
                                          double ceiling = std::numeric_limits<double>::infinity(),
                                          std::vector<ClearPlace>* trail = nullptr);

// The centre and the radius of the circle in the plane of three centres that touches the three
// balls from outside: the widest probe that passes between them, as far as other balls let it.
// Negative if a probe passes only when the balls shrink. Nothing if there is no such circle.
std::optional<ClearPlace> gate_place(const std::array<Sphere, 3>& balls);

}  // namespace vdwmesh
