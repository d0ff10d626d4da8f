// Boxes that grow around points and other boxes, and whether two of them meet. For host and device.
#pragma once

#include <algorithm>
#include <limits>

#include "core/host_device.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// The empty box: the smallest box around it and any other box is the other box.
VDWMESH_HD constexpr Box empty_box() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

// Extends the box to the smallest one around both.
VDWMESH_HD constexpr void include(Box& box, const Box& other) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::min(box.lower[axis], other.lower[axis]);
    box.upper[axis] = std::max(box.upper[axis], other.upper[axis]);
  }
}
VDWMESH_HD constexpr void include(Box& box, const Vec3d& p) { include(box, Box{p, p}); }

VDWMESH_HD constexpr Vec3d middle(const Box& box) {
  return box.lower + 0.5 * (box.upper - box.lower);
}

// Whether two boxes have a point in common. Faces belong to the boxes.
VDWMESH_HD constexpr bool meet(const Box& a, const Box& b) {
  bool does = true;
  for (int axis = 0; axis < 3; ++axis) {
    does = does && a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis];
  }
  return does;
}

// The bounding box of a ball.
VDWMESH_HD constexpr Box box_of(const Sphere& ball) {
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  return {ball.center - r, ball.center + r};
}
VDWMESH_HD constexpr void include(Box& box, const Sphere& ball) { include(box, box_of(ball)); }

// The smallest box around all of the points, balls or boxes.
template <class Items>
Box box_around(const Items& items) {
  Box box = empty_box();
  for (const auto& item : items) include(box, item);
  return box;
}

}  // namespace vdwmesh
