// Boxes that grow around points and other boxes.
#pragma once

#include <algorithm>
#include <limits>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The empty box: the smallest box around it and any other box is the other box.
constexpr Box empty_box() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

// Extends the box to the smallest one around both.
constexpr void include(Box& box, const Box& other) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(box.lower[axis], other.lower[axis]);
    box.upper[axis] = std::max(box.upper[axis], other.upper[axis]);
  }
}
constexpr void include(Box& box, const Vec3d& p) { include(box, Box{p, p}); }

constexpr Vec3d middle(const Box& box) { return box.lower + 0.5 * (box.upper - box.lower); }

}  // namespace vdwmesh
