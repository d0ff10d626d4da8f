// Vectors over any number type: double, exact numbers, floats of a hundred digits. Scalar and cross
// products use plain multiplication, because exact numbers have no fma.
#pragma once

#include "core/host_device.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::numbers {

template <class T>
struct Vector {
  T x, y, z;
};

// The vector from the centre of a to that of b. The coordinates are converted to T before they are
// subtracted, so an exact T gives an exact difference.
template <class T>
Vector<T> from_to(const Sphere& a, const Sphere& b) {
  return {T(b.center.x) - T(a.center.x), T(b.center.y) - T(a.center.y),
          T(b.center.z) - T(a.center.z)};
}

template <class T>
VDWMESH_HD T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
VDWMESH_HD Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace vdwmesh::numbers
