// Counting what becomes of the vertices of a level.
#pragma once

#include <algorithm>
#include <cstddef>

#include "core/blocks.hpp"
#include "core/monitor.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

inline ProjectionStats join(const ProjectionStats& a, const ProjectionStats& b) {
  return {a.projected + b.projected,
          a.unconverged + b.unconverged,
          a.out_of_reach + b.out_of_reach,
          a.undone + b.undone,
          a.turned + b.turned,
          std::max(a.iterations_max, b.iterations_max),
          std::max(a.residual_max, b.residual_max)};
}

// Calls body(i, stats), which adds to `stats`, for all i < count and returns the sum. Asks the
// monitor once in kBlock indices whether the caller has cancelled, and throws Cancelled if so. The
// advance of 0 steps reports no progress.
template <class Body>
ProjectionStats tally(std::size_t count, Monitor* monitor, const Body& body) {
  const auto watched = [&](std::size_t i, ProjectionStats& stats) {
    if (i % kBlock == 0) advance(monitor, 0);
    body(i, stats);
  };
  return reduce_all(count, ProjectionStats{}, watched, join);
}

// Counts a vertex that is not searched for: as projected if its distance from the pieces of the
// surface that it belongs to is within kProjectionTolerance, and as unconverged otherwise.
inline void count_residual(double residual, ProjectionStats& stats) {
  if (!(residual <= kProjectionTolerance)) {
    ++stats.unconverged;
    return;
  }
  ++stats.projected;
  stats.residual_max = std::max(stats.residual_max, residual);
}

}  // namespace vdwmesh
