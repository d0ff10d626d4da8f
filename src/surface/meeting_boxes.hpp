// Whether two boxes have a point in common, for searches that first leave out what is far away by
// the box around all that is asked for.
#pragma once

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Faces belong to the boxes.
constexpr bool meet(const Box& a, const Box& b) {
  bool does = true;
  for (int axis = 0; axis < 3; ++axis) {
    does = does && a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis];
  }
  return does;
}

}  // namespace vdwmesh
