// Directions in space.
#pragma once

#include <cmath>

#include "core/vec3.hpp"

namespace vdwmesh {

inline double triple_product(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b, c));
}

// Precondition: not zero.
inline Vec3d unit(const Vec3d& v) { return (1 / norm(v)) * v; }

// A direction at right angles to a unit vector: from the coordinate axis that is farthest off.
inline Vec3d any_orthogonal(const Vec3d& axis) {
  const Vec3d size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
  Vec3d far{0, 0, 0};
  far[size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2)] = 1;
  return unit(far - dot(far, axis) * axis);
}

}  // namespace vdwmesh
