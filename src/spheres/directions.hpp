// Helpers for vectors in space: triple product, normalisation, a perpendicular direction.
#pragma once

#include <cmath>

#include "core/vec3.hpp"

namespace vdwmesh {

// The determinant of the three vectors: six times the signed volume of the tetrahedron they span.
VDWMESH_HD inline double triple_product(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return dot(a, cross(b, c));
}

// v scaled to length 1. Precondition: v is not zero.
VDWMESH_HD inline Vec3d unit(const Vec3d& v) { return (1 / norm(v)) * v; }

// Returns a unit vector at right angles to the unit vector `axis`. It starts from the coordinate
// axis that makes the largest angle with `axis`. That angle is at least 54 degrees, because the
// smallest of three components of a unit vector is at most 1/sqrt(3), so nothing cancels in the
// subtraction.
VDWMESH_HD inline Vec3d any_orthogonal(const Vec3d& axis) {
  const Vec3d size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
  Vec3d far{0, 0, 0};
  far[size.x <= size.y && size.x <= size.z ? 0 : (size.y <= size.z ? 1 : 2)] = 1;
  return unit(far - dot(far, axis) * axis);
}

}  // namespace vdwmesh
