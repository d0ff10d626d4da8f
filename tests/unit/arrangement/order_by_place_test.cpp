// The order of balls, simplices, corners and arcs follows from places: a part of a set, with the
// balls around it and the frame of the whole set, gets the simplices, corners and arcs of its own
// balls in the order of the whole set, and corners and arcs with the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <vector>

#include "complex/boundary/exposed_arcs.hpp"
#include "complex/placed_balls.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "measures/exposed_boundary.hpp"
#include "spheres/spatial_frame.hpp"
#include "support/ball_families.hpp"

namespace vdwmesh::testing {
namespace {

struct Arranged {
  explicit Arranged(PowerTriangulation triangulation)
      : t(std::move(triangulation)), complex(dual_complex(t)), arcs(exposed_arcs(t, complex)) {}

  PowerTriangulation t;
  DualComplex complex;
  std::vector<ExposedArc> arcs;
};

bool is_sorted_and_distinct(const auto& items) {
  return std::ranges::adjacent_find(items, std::ranges::greater_equal()) == items.end();
}

void expect_order(const Arranged& whole) {
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const DualEdge& e : whole.complex.edges) edges.push_back(e.vertices);
  for (const DualTriangle& f : whole.complex.triangles) {
    triangles.push_back(f.vertices);
    EXPECT_TRUE(is_sorted_and_distinct(f.vertices));
  }
  EXPECT_TRUE(is_sorted_and_distinct(edges));
  EXPECT_TRUE(is_sorted_and_distinct(triangles));
  EXPECT_TRUE(is_sorted_and_distinct(whole.arcs));
}

// Whether the closed balls meet, or rounding may think so.
bool may_meet(const Sphere& a, const Sphere& b) {
  return norm(a.center - b.center) <= (a.radius + b.radius) * (1 + 1e-9);
}

// A part: every third of the balls in their order is its own, and all that meet one of these are
// near. `ids` are their numbers in the whole set.
struct Part {
  std::vector<SphereId> ids;
  std::vector<std::uint8_t> is_own;  // by id
};

Part part_of(const Arranged& whole, std::span<const Sphere> spheres, std::size_t third) {
  const std::size_t count = whole.t.ids.size();
  Part part{{}, std::vector<std::uint8_t>(spheres.size(), 0)};
  for (std::size_t b = count * third / 3; b < count * (third + 1) / 3; ++b) {
    part.is_own[whole.t.ids[b]] = 1;
  }
  for (SphereId i = 0; i < spheres.size(); ++i) {
    bool is_near = false;
    for (SphereId j = 0; j < spheres.size() && !is_near; ++j) {
      is_near = part.is_own[j] && may_meet(spheres[i], spheres[j]);
    }
    if (is_near) part.ids.push_back(i);
  }
  return part;
}

// What there is at the own balls of a part: names are ids in the whole set.
struct AtPart {
  std::vector<std::vector<SphereId>> simplices;
  std::vector<std::array<double, 3>> corners;  // coordinates, in their order
  std::vector<std::array<double, 8>> arcs;     // numbers of ids, centre, sweep, radius, cosine
  bool operator==(const AtPart&) const = default;
};

// `id_of` gives the id in the whole set of a ball.
AtPart at_part(const Arranged& a, const Part& part, const auto& id_of) {
  AtPart found;
  const auto add = [&](const auto& vertices) {
    std::vector<SphereId> ids;
    for (const std::uint32_t v : vertices) ids.push_back(id_of(v));
    const bool own = std::ranges::any_of(ids, [&](SphereId i) { return part.is_own[i] != 0; });
    if (own) found.simplices.push_back(ids);
    return own;
  };
  for (const DualEdge& e : a.complex.edges) add(e.vertices);
  for (const DualTriangle& f : a.complex.triangles) {
    if (add(f.vertices)) found.simplices.back().push_back(2u * f.exposed[0] + f.exposed[1]);
  }
  const BoundaryArcs boundary = boundary_arcs(a.t, exposed_boundary(a.t, a.complex));
  for (const BoundaryCorner& c : boundary.corners) {
    if (add(c.balls)) found.corners.push_back({c.position.x, c.position.y, c.position.z});
  }
  for (const BoundaryArc& arc : boundary.arcs) {
    if (!add(arc.balls)) continue;
    found.arcs.push_back({static_cast<double>(id_of(arc.balls[0])),
                          static_cast<double>(id_of(arc.balls[1])), arc.center.x, arc.center.y,
                          arc.center.z, arc.sweep, arc.radius, arc.cosine.x});
  }
  return found;
}

class OrderByPlace : public ::testing::TestWithParam<unsigned> {};

// Features that become points may join corners of several parts, so they are left out here.
bool has_features(const Arranged& a) {
  const BoundaryArcs boundary = boundary_arcs(a.t, exposed_boundary(a.t, a.complex));
  return boundary.points + boundary.contacts + boundary.joins > 0;
}

TEST_P(OrderByPlace, OfAPartIsThatOfTheWhole) {
  Dice dice(GetParam());
  const BallFamily& family = kBallFamilies[GetParam() % std::size(kBallFamilies)];
  SCOPED_TRACE(family.name);
  const std::vector<Sphere> spheres = family.make(dice);
  const SphereSet set(spheres);
  const Arranged whole(triangulate(set));
  expect_order(whole);
  if (has_features(whole)) return;
  for (std::size_t third = 0; third < 3; ++third) {
    const Part part = part_of(whole, spheres, third);
    if (part.ids.empty()) continue;
    std::vector<Sphere> near;
    for (const SphereId i : part.ids) near.push_back(spheres[i]);
    const Arranged local(
        triangulate(placed_balls(SphereSet(near), spatial_frame(set), scale_exponent(set))));
    const AtPart of_whole = at_part(whole, part, [&](std::uint32_t v) { return whole.t.ids[v]; });
    const AtPart of_part =
        at_part(local, part, [&](std::uint32_t v) { return part.ids[local.t.ids[v]]; });
    EXPECT_EQ(of_part.simplices, of_whole.simplices);
    EXPECT_EQ(of_part.corners, of_whole.corners);
    EXPECT_EQ(of_part.arcs, of_whole.arcs);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, OrderByPlace, ::testing::Range(0u, 60u));

}  // namespace
}  // namespace vdwmesh::testing
