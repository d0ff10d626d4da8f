// The arrangement of a set of balls, as far as the crease-exact mesher needs it.
#pragma once

#include <cstdint>

#include "complex/power_triangulation.hpp"
#include "core/errors.hpp"
#include "measures/exposed_boundary.hpp"

namespace vdwmesh {

class Monitor;

// It is computed once and serves all attempts to mesh it. Lengths are scaled as in PlacedBalls.
struct Arrangement {
  PlacedBalls balls;
  ExposedBoundary boundary;
};

// Arranges the balls by their regular triangulation, which is exact; only the boundary is kept.
// Throws InvalidInput and Cancelled, and LimitExceeded as triangulate() does.
Arrangement arrange(const SphereSet& spheres, Monitor* monitor = nullptr,
                    std::uint64_t memory_limit = kNoMemoryLimit);
Arrangement arrange(PlacedBalls balls, Monitor* monitor = nullptr,
                    std::uint64_t memory_limit = kNoMemoryLimit);

// triangulate(), with blocks for all cores even if there are few balls.
PowerTriangulation triangulate_for_mesh(PlacedBalls balls, Monitor* monitor,
                                        std::uint64_t memory_limit);

}  // namespace vdwmesh
