// Pockets followed through frames, such as those of a trajectory, by the spheres at which they lie.
#pragma once

#include <cstdint>
#include <vector>

#include "pockets/pockets.hpp"

namespace vdwmesh {

struct TrackingOptions {
  // The least overlap of the spheres of a pocket and of its track: the number that both have by the
  // number that either has (Jaccard's index). Two sets of one size have it if half of each is
  // common.
  double least_overlap = 1.0 / 3;
  // Frames for which a track waits for a pocket that is not there. Then it ends, and memory does
  // not grow with the number of frames.
  std::uint64_t patience = 10;
};

// What a pocket continues.
struct TrackStep {
  std::uint64_t track;  // its number, from 1 in the order of appearance
  double overlap;       // with the pocket that the track had last; 0: the track begins here
};

// Says of the pockets of one frame after another which tracks they continue. A track is where its
// last pocket was (Pocket::corners). Pairs of track and pocket are taken by falling overlap, of
// equal ones first the lower track, then the pocket that stands first; each track and pocket is
// taken once. Pockets that remain begin tracks, in their order. Spheres keep their ids from frame
// to frame.
class PocketTracker {
 public:
  // Throws InvalidInput unless the least overlap is above 0 and at most 1.
  explicit PocketTracker(const TrackingOptions& options = {});

  // For each pocket of the next frame, in their order.
  std::vector<TrackStep> follow(const std::vector<Pocket>& pockets);

 private:
  struct Track {
    std::uint64_t number, last_frame;
    std::vector<SphereId> corners;
  };

  TrackingOptions options_;
  std::vector<Track> tracks_;  // by ascending numbers
  std::uint64_t frame_ = 0, begun_ = 0;
};

}  // namespace vdwmesh
