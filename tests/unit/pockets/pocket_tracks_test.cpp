// Pockets followed through frames: overlaps and tracks counted by hand.
#include "pockets/pocket_tracks.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/errors.hpp"

namespace vdwmesh::testing {
namespace {

using Sets = std::vector<std::vector<SphereId>>;

std::vector<Pocket> pockets_at(const Sets& sets) {
  std::vector<Pocket> pockets;
  for (const auto& ids : sets) pockets.emplace_back().corners = ids;
  return pockets;
}

std::vector<std::uint64_t> tracks(PocketTracker& tracker, const Sets& sets) {
  std::vector<std::uint64_t> numbers;
  for (const TrackStep& step : tracker.follow(pockets_at(sets))) numbers.push_back(step.track);
  return numbers;
}

using Numbers = std::vector<std::uint64_t>;

TEST(PocketTracks, FollowTheirSpheresWhateverTheirOrder) {
  PocketTracker tracker;
  EXPECT_EQ(tracks(tracker, {{1, 2, 3, 4}, {7, 8, 9}}), (Numbers{1, 2}));
  const auto steps = tracker.follow(pockets_at({{8, 9, 10}, {20, 21}, {1, 2, 3, 4}}));
  EXPECT_EQ(steps[0].track, 2u);
  EXPECT_EQ(steps[0].overlap, 0.5);  // 8 and 9 of 7 to 10
  EXPECT_EQ(steps[1].track, 3u);
  EXPECT_EQ(steps[1].overlap, 0);
  EXPECT_EQ(steps[2].track, 1u);
  EXPECT_EQ(steps[2].overlap, 1);
}

// A third is enough, less is not; and the place moves along with the pocket.
TEST(PocketTracks, NeedTheLeastOverlap) {
  PocketTracker tracker;
  EXPECT_EQ(tracks(tracker, {{1, 2}}), (Numbers{1}));
  EXPECT_EQ(tracks(tracker, {{2, 3}}), (Numbers{1}));        // 1 of 3
  EXPECT_EQ(tracks(tracker, {{1, 2, 4, 5}}), (Numbers{2}));  // 1 of 5 with the last place
}

// When pockets join, the track of the larger overlap goes on; when they part, the other waits.
TEST(PocketTracks, OfTwoThatJoinTheLikerGoesOn) {
  PocketTracker tracker({.least_overlap = 0.25, .patience = 1});
  EXPECT_EQ(tracks(tracker, {{1, 2}, {3, 4, 5, 6}}), (Numbers{1, 2}));
  EXPECT_EQ(tracks(tracker, {{1, 2, 3, 4, 5, 6}}), (Numbers{2}));
  EXPECT_EQ(tracks(tracker, {{3, 4, 5, 6}, {1, 2}}), (Numbers{2, 1}));
}

TEST(PocketTracks, EqualOverlapsGoToTheLowerTrackAndTheFirstPocket) {
  PocketTracker tracker;
  EXPECT_EQ(tracks(tracker, {{1, 2}, {3, 4}}), (Numbers{1, 2}));
  // Each pocket has one of three in common with each track.
  EXPECT_EQ(tracks(tracker, {{1, 3}, {2, 4}}), (Numbers{1, 2}));
}

TEST(PocketTracks, EndWhenPatienceDoes) {
  PocketTracker tracker({.patience = 2});
  EXPECT_EQ(tracks(tracker, {{1, 2, 3}}), (Numbers{1}));
  EXPECT_EQ(tracks(tracker, {}), Numbers{});
  EXPECT_EQ(tracks(tracker, {}), Numbers{});
  EXPECT_EQ(tracks(tracker, {{1, 2, 3}}), (Numbers{1}));
  for (int frame = 0; frame < 3; ++frame) tracks(tracker, {});
  EXPECT_EQ(tracks(tracker, {{1, 2, 3}}), (Numbers{2}));
}

TEST(PocketTracks, RefuseAnOverlapThatIsNone) {
  EXPECT_THROW(PocketTracker({.least_overlap = 0}), InvalidInput);
  EXPECT_THROW(PocketTracker({.least_overlap = 1.5}), InvalidInput);
}

// The vertices of the cube's only pocket are its corners.
TEST(PocketTracks, CornersAreTheBallsOfTheTetrahedra) {
  std::vector<Sphere> cube;
  for (int c = 0; c < 8; ++c)
    cube.push_back({{4.6 * (c & 1), 4.6 * (c >> 1 & 1), 4.6 * (c >> 2 & 1)}, 2.9});
  const Pocket pocket = pockets(SphereSet(cube)).pockets.at(0);
  EXPECT_EQ(pocket.corners, (std::vector<SphereId>{0, 1, 2, 3, 4, 5, 6, 7}));
}

}  // namespace
}  // namespace vdwmesh::testing
