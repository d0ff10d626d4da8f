// PocketTracker: an index of the tracks' spheres gives the pairs that overlap, so the work of a
// frame does not grow with the product of tracks and pockets.
#include "pockets/pocket_tracks.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using IdAndTrack = std::pair<SphereId, std::size_t>;

// A pocket that may continue a track; both are indices.
struct Continuation {
  double overlap;
  std::size_t track, pocket;
};

// The numbers of spheres that a pocket has in common with tracks, of those with any.
std::map<std::size_t, std::size_t> common_spheres(const std::vector<IdAndTrack>& index,
                                                  const std::vector<SphereId>& corners) {
  std::map<std::size_t, std::size_t> common;
  for (const SphereId id : corners) {
    const auto first = std::ranges::lower_bound(index, IdAndTrack{id, 0});
    for (auto at = first; at != index.end() && at->first == id; ++at) ++common[at->second];
  }
  return common;
}

}  // namespace

PocketTracker::PocketTracker(const TrackingOptions& options) : options_(options) {
  if (!(options.least_overlap > 0 && options.least_overlap <= 1)) {
    throw InvalidInput("overlap: is above 0 and at most 1, the share of spheres in common");
  }
}

std::vector<TrackStep> PocketTracker::follow(const std::vector<Pocket>& pockets) {
  std::vector<IdAndTrack> index;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    for (const SphereId id : tracks_[t].corners) index.push_back({id, t});
  }
  std::ranges::sort(index);
  // Both numbers are whole and small, so equal overlaps are equal quotients.
  std::vector<Continuation> found;
  for (std::size_t p = 0; p < pockets.size(); ++p) {
    for (const auto& [t, common] : common_spheres(index, pockets[p].corners)) {
      const std::size_t either = pockets[p].corners.size() + tracks_[t].corners.size() - common;
      const double overlap = static_cast<double>(common) / static_cast<double>(either);
      if (overlap >= options_.least_overlap) found.push_back({overlap, t, p});
    }
  }
  std::ranges::sort(found, [](const Continuation& a, const Continuation& b) {
    return std::tuple(-a.overlap, a.track, a.pocket) < std::tuple(-b.overlap, b.track, b.pocket);
  });
  ++frame_;
  std::vector<TrackStep> steps(pockets.size(), {0, 0});
  for (const auto& [overlap, t, p] : found) {
    Track& track = tracks_[t];
    if (track.last_frame == frame_ || steps[p].track > 0) continue;
    track.last_frame = frame_;
    track.corners = pockets[p].corners;
    steps[p] = {track.number, overlap};
  }
  std::erase_if(tracks_, [&](const Track& t) { return frame_ - t.last_frame > options_.patience; });
  for (std::size_t p = 0; p < pockets.size(); ++p) {
    if (steps[p].track > 0) continue;
    steps[p].track = ++begun_;
    tracks_.push_back({begun_, frame_, pockets[p].corners});
  }
  return steps;
}

}  // namespace vdwmesh
