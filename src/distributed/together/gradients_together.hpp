// Derivatives of the exact area and volume of a union of balls, by all ranks together.
#pragma once

#include <cstdint>
#include <vector>

#include "distributed/ranks.hpp"
#include "measures/union_gradients.hpp"

namespace vdwmesh {

struct GradientsTogether {
  std::vector<BallGradient> gradients;  // in the order of the SphereSet
  std::uint64_t kink_spheres = 0;       // as in UnionGradients
};

// The gradients of union_gradients() without weights, bit for bit, on the first rank; on the others
// the result means nothing. Every rank has all spheres and may use `memory_limit` bytes. Throws, on
// all ranks, what union_gradients() throws, and LimitExceeded. Collective.
GradientsTogether gradients_together(const Ranks& ranks, const SphereSet& spheres,
                                     std::uint64_t memory_limit, Monitor* monitor = nullptr);

}  // namespace vdwmesh
