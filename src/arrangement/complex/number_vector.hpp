// Vectors over any number type: doubles, exact numbers, a hundred digits. Plain products, because
// such types have no fma.
#pragma once

#include "spheres/sphere_set.hpp"

namespace vdwmesh::numbers {

template <class T>
struct Vector {
  T x, y, z;
};

template <class T>
Vector<T> from_to(const Sphere& a, const Sphere& b) {
  return {T(b.center.x) - T(a.center.x), T(b.center.y) - T(a.center.y),
          T(b.center.z) - T(a.center.z)};
}

template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

}  // namespace vdwmesh::numbers
