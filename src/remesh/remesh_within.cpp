// remesh_within(): searches for the longest edges whose mesh is near enough.
//
// Between curved surface and flat triangle the distance grows as the square of the edge length. So
// a next length follows from the last one's distance. Where features are joined or corners are
// sharp the distance may not grow evenly, so the lengths known to be too long and short enough
// bracket the next one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "excluded/excluded_bounds.hpp"
#include "remesh/surface_remesher.hpp"

namespace vdwmesh {
namespace {

constexpr int kMostTries = 12;
// The search ends with a distance of at least this share of what is allowed, or with lengths that
// are too long by at most this factor.
constexpr double kNearEnough = 0.75, kCloseBracket = 1.08;
// Of the proven distance; the number of points measured grows as its inverse square.
constexpr double kGap = 0.2;
constexpr double kAim = 0.88;           // the share that a next length aims at
constexpr double kLongestEdge = 3;      // Å: longer than the radii of all atoms
constexpr double kShortestEdge = 0.02;  // Å: 10,000 triangles per Å²

}  // namespace

RemeshedSurface remesh_within(const SphereSet& atoms, double max_distance,
                              const RemeshOptions& options) {
  if (!(max_distance > 0) || !std::isfinite(max_distance)) {
    throw InvalidInput(
        fmt::format("the distance must be positive and finite, not {} Å", max_distance));
  }
  const ExcludedPart part = options.exterior ? ExcludedPart::exterior : ExcludedPart::complete;
  RemeshedSurface best;
  // Lengths of which meshes are near enough and too far, and the least bound of the latter.
  double good = 0, bad = 2 * kLongestEdge, least = std::numeric_limits<double>::infinity();
  double length = std::clamp(options.edge_length, kShortestEdge, kLongestEdge);
  for (int tries = 1; tries <= kMostTries; ++tries) {
    RemeshOptions now = options;
    now.edge_length = length;
    RemeshedSurface made = remesh_excluded(atoms, now);
    const double farthest =
        excluded_distance_bounds(
            made.mesh, atoms, options.probe,
            {.gap = kGap, .memory_limit = options.memory_limit, .monitor = options.monitor}, part)
            .upper();
    if (farthest <= max_distance) {
      good = length;
      made.stats.farthest = farthest;
      best = std::move(made);
      if (farthest >= kNearEnough * max_distance || length == kLongestEdge) break;
    } else {
      bad = length;
      least = std::min(least, farthest);
      if (length == kShortestEdge) break;
    }
    if (good > 0 && bad <= kCloseBracket * good) break;
    length *= std::clamp(std::sqrt(kAim * max_distance / farthest), 0.25, 2.0);
    if (good > 0 && !(length > good && length < bad)) length = std::sqrt(good * bad);
    if (good == 0) length = std::min(length, 0.9 * bad);
    length = std::clamp(length, kShortestEdge, kLongestEdge);
  }
  if (good > 0) return best;
  throw LimitExceeded(fmt::format(
      "no mesh was proven to be within {} Å of the excluded surface, only within {:.3g} "
      "Å; allow a larger distance",
      max_distance, least));
}

}  // namespace vdwmesh
