// Directions that are spread evenly over the sphere, for estimates.
#pragma once

#include <cmath>
#include <numbers>

#include "core/vec3.hpp"

namespace vdwmesh {

// The k-th of `count` unit vectors, from 0 (Fibonacci lattice).
inline Vec3d even_direction(int k, int count) {
  const double z = 1 - (2 * k + 1) / static_cast<double>(count);
  const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace vdwmesh
