// How far from its spheres a vertex of a crease-exact mesh may lie.
#pragma once

#include <algorithm>

#include "core/vec3.hpp"
#include "creases/exact_mesher.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

// Å: roundings of the numbers given; and where features were made points, a place as large as they
// are, with some room for steps.
inline double allowed_distance(const SphereSet& spheres, const ExactMeshStats& stats) {
  constexpr double kRounding = 1e-12, kSteps = 10;
  double largest = 0, farthest = 0;
  for (const Sphere& s : spheres.spheres()) {
    largest = std::max(largest, s.radius);
    farthest = std::max(farthest, norm(s.center));
  }
  const bool reduced = stats.points + stats.contacts + stats.joins > 0;
  return kRounding * (largest + farthest) +
         (reduced ? (kSteps * stats.arc_size + 2 * stats.circle_size) * largest : 0);
}

}  // namespace vdwmesh::testing
