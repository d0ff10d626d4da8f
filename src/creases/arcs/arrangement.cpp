// arrange(): triangulates, finds the dual complex, and keeps its boundary alone.
#include "creases/arcs/arrangement.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <utility>

#include "complex/dual_complex.hpp"

namespace vdwmesh {
namespace {

// Into how many blocks a triangulation is divided: as many as there are cores, of some hundred
// balls at least. Small blocks cost more work in all than one for a small set, but less time.
std::size_t blocks_of(std::size_t balls) {
  constexpr std::size_t kLeastBalls = 500;
  const auto cores =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::clamp<std::size_t>(balls / kLeastBalls, 1, cores);
}

}  // namespace

PowerTriangulation triangulate_for_mesh(PlacedBalls balls, Monitor* monitor,
                                        std::uint64_t memory_limit) {
  const std::size_t blocks = blocks_of(balls.balls.size());
  return triangulate(std::move(balls), monitor, blocks, memory_limit);
}

Arrangement arrange(const SphereSet& spheres, Monitor* monitor, std::uint64_t memory_limit) {
  return arrange(placed_balls(spheres), monitor, memory_limit);
}

Arrangement arrange(PlacedBalls balls, Monitor* monitor, std::uint64_t memory_limit) {
  PowerTriangulation t = triangulate_for_mesh(std::move(balls), monitor, memory_limit);
  ExposedBoundary boundary = exposed_boundary(t, dual_complex(t, monitor));
  return {std::move(static_cast<PlacedBalls&>(t)), std::move(boundary)};
}

}  // namespace vdwmesh
