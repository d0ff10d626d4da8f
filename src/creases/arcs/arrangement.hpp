// The arrangement of a set of balls, as far as the crease-exact mesher needs it.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "complex/dual_complex.hpp"
#include "core/monitor.hpp"
#include "measures/exposed_boundary.hpp"

namespace vdwmesh {

// The triangulation of all balls and its dual complex.
struct WholeComplex {
  PowerTriangulation triangulation;
  DualComplex complex;
};

// It is computed once and serves all attempts to mesh it. Lengths are scaled as in PlacedBalls.
struct Arrangement {
  PlacedBalls balls;
  ExposedBoundary boundary;
  // If it was needed to decide the boundary.
  std::optional<WholeComplex> whole;
  // By ball: double precision did not decide its power cell, so a triangulation did.
  std::vector<std::uint8_t> is_doubtful;
  bool is_ordinary = true;  // no ball is of a size for which numbers would over- or underflow
};

// Arranges the balls by the power cell of each (arcs/boundary_rows.hpp). Of balls that this leaves
// in doubt, a triangulation of the balls around them decides, which is exact. So the boundary is
// that of the dual complex, exposed_boundary(), but for the last bits of the areas. Throws
// InvalidInput and Cancelled, and LimitExceeded as triangulate() does.
Arrangement arrange(const SphereSet& spheres, Monitor* monitor = nullptr,
                    std::uint64_t memory_limit = kNoMemoryLimit);
Arrangement arrange(PlacedBalls balls, Monitor* monitor = nullptr,
                    std::uint64_t memory_limit = kNoMemoryLimit);

// Triangulates all balls of an arrangement.
WholeComplex whole_complex(const PlacedBalls& balls, Monitor* monitor = nullptr,
                           std::uint64_t memory_limit = kNoMemoryLimit);

}  // namespace vdwmesh
