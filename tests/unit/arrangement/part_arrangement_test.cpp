// Parts of a set, each arranged with nothing but the balls that touch it: behind each other they
// have the corners and arcs of the whole set, in its order and with the same bits, and every own
// ball has its neighbours.
#include "creases/arcs/part_arrangement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "support/family_sets.hpp"

namespace vdwmesh::testing {
namespace {

// Corners and arcs whose balls have names that do not depend on the part.
struct NamedCorner {
  std::array<SphereId, 3> ids;
  Vec3d position;
  bool operator==(const NamedCorner&) const = default;
};
struct PlacedArc {
  std::array<SphereId, 2> ids;
  std::array<NamedCorner, 2> ends;  // of a whole circle without meaning, and equal
  Vec3d center, cosine, sine;
  double sweep, radius;
  bool operator==(const PlacedArc&) const = default;
};

NamedCorner named(const BoundaryCorner& c, const std::vector<SphereId>& ids) {
  return {{ids[c.balls[0]], ids[c.balls[1]], ids[c.balls[2]]}, c.position};
}

PlacedArc named(const BoundaryArc& a, const BoundaryArcs& all, const std::vector<SphereId>& ids) {
  PlacedArc out{
      {ids[a.balls[0]], ids[a.balls[1]]}, {}, a.center, a.cosine, a.sine, a.sweep, a.radius};
  for (std::size_t k = 0; k < 2 && !a.is_circle(); ++k) {
    out.ends[k] = named(all.corners[a.ends[k]], ids);
  }
  return out;
}

// The ids of a ball's neighbours, in their order.
std::vector<SphereId> neighbors_of(const Arrangement& a, std::uint32_t ball) {
  std::vector<SphereId> ids;
  for (const std::uint32_t n : a.boundary.neighbors(ball)) ids.push_back(a.balls.ids[n]);
  return ids;
}

bool has_features(const BoundaryArcs& boundary) {
  return boundary.points + boundary.contacts + boundary.joins > 0;
}

// What the parts have, one behind the other.
struct AllParts {
  std::vector<SphereId> balls;
  std::vector<NamedCorner> corners;
  std::vector<PlacedArc> arcs;
  bool has_features = false;
};

void add_part(const ArrangedPart& part, const Arrangement& whole,
              const std::vector<std::uint32_t>& ball_of, AllParts& all) {
  // Joined corners may be named after balls of other parts, so nothing is looked at then.
  all.has_features = all.has_features || has_features(part.boundary);
  if (all.has_features) return;
  const std::vector<SphereId>& ids = part.arrangement.balls.ids;
  const MeshShare& share = part.part.share;
  for (std::uint32_t b = share.balls.first; b < share.balls.second; ++b) {
    all.balls.push_back(ids[b]);
    const auto neighbors = neighbors_of(part.arrangement, b);
    const auto expected = neighbors_of(whole, ball_of[ids[b]]);
    // A ball without arcs may have an empty row.
    if (!neighbors.empty() && !expected.empty()) {
      EXPECT_EQ(neighbors, expected);
    }
  }
  for (std::uint32_t c = share.corners.first; c < share.corners.second; ++c) {
    all.corners.push_back(named(part.boundary.corners[c], ids));
  }
  for (std::uint32_t a = share.arcs.first; a < share.arcs.second; ++a) {
    all.arcs.push_back(named(part.boundary.arcs[a], part.boundary, ids));
  }
}

// Returns whether nothing had to be reduced to points, which concerns the whole set.
bool expect_whole_in_parts(const std::vector<Sphere>& balls, std::size_t parts) {
  const SphereSet spheres(balls);
  const Arrangement whole = arrange(spheres);
  const BoundaryArcs boundary = boundary_arcs(whole.balls, whole.boundary);
  std::vector<std::uint32_t> ball_of(balls.size(), kNoIndex);  // by id
  for (std::uint32_t b = 0; b < whole.balls.ids.size(); ++b) ball_of[whole.balls.ids[b]] = b;
  AllParts all;
  for (std::size_t number = 0; number < parts; ++number) {
    add_part(arrange_part(spheres, number, parts, ExactMeshOptions()), whole, ball_of, all);
  }
  if (has_features(boundary)) {
    EXPECT_TRUE(all.has_features);
  }
  if (all.has_features) return false;
  EXPECT_EQ(all.balls, whole.balls.ids);
  std::vector<NamedCorner> corners;
  for (const BoundaryCorner& c : boundary.corners) corners.push_back(named(c, whole.balls.ids));
  std::vector<PlacedArc> arcs;
  for (const BoundaryArc& a : boundary.arcs) arcs.push_back(named(a, boundary, whole.balls.ids));
  EXPECT_EQ(all.corners == corners, true) << corners.size() << " corners";
  EXPECT_EQ(all.arcs == arcs, true) << arcs.size() << " arcs";
  return true;
}

TEST(PartArrangement, PartsOfSetsUnlikeProteinsAreThoseOfTheWhole) {
  std::size_t without_features = 0;
  for_sets_of_families(150, [&](const std::vector<Sphere>& balls, Dice&, unsigned seed) {
    without_features += expect_whole_in_parts(balls, 2 + seed % 4);
  });
  EXPECT_GT(without_features, 50u);
}

TEST(PartArrangement, OneBallAndMoreProcessesThanBalls) {
  EXPECT_TRUE(expect_whole_in_parts({{{0, 0, 0}, 1.5}}, 3));
  EXPECT_TRUE(expect_whole_in_parts({{{0, 0, 0}, 1.5}, {{1, 0.5, 0}, 1.5}, {{0, 0, 0}, 1}}, 7));
}

// The area that each part has of the boundary, as a fraction of all.
std::vector<double> shares_of_area(const std::vector<Sphere>& balls, std::size_t parts) {
  std::vector<double> shares;
  for (std::size_t number = 0; number < parts; ++number) {
    const ArrangedPart part = arrange_part(SphereSet(balls), number, parts, ExactMeshOptions());
    const MeshShare::Run own = part.part.share.balls;
    shares.push_back(0);
    for (std::uint32_t b = own.first; b < own.second; ++b) {
      shares.back() += part.arrangement.boundary.areas[b];
    }
  }
  const double whole = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= whole;
  return shares;
}

// Balls inside a block have no area, and as many balls beside it have all of theirs.
TEST(PartArrangement, PartsHaveAboutEqualAreasAndNotEquallyManyBalls) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 1000; ++i) {
    const double x = i % 10, y = i / 10 % 10, z = i / 100;
    balls.push_back({{x, y, z}, 1.5});
    if (i % 2 == 0) balls.push_back({{100 + 5 * x, 5 * y, 5 * z}, 1.5});
  }
  for (const std::size_t parts : {2u, 5u}) {
    for (const double share : shares_of_area(balls, parts)) {
      EXPECT_NEAR(share, 1.0 / static_cast<double>(parts), 0.2 / static_cast<double>(parts));
    }
  }
}

// The cells of a curve through so wide a cube are wider than all of the other balls.
TEST(PartArrangement, ADistantBallLeavesNoPartEmpty) {
  Dice dice(3);
  std::vector<Sphere> balls;
  for (int i = 0; i < 600; ++i) {
    balls.push_back({{dice.real(0, 30), dice.real(0, 30), dice.real(0, 30)}, 1.5});
  }
  balls.push_back({{1e6, 1e6, -1e6}, 1.5});
  for (const double share : shares_of_area(balls, 4)) EXPECT_NEAR(share, 0.25, 0.06);
}

}  // namespace
}  // namespace vdwmesh::testing
