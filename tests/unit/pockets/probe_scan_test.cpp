// Places for probes of all radii and ways out, against formulas, and against the pockets that the
// triangulation of one radius has.
#include "pockets/probe_scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/errors.hpp"
#include "pockets/pockets.hpp"
#include "support/dice.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kRounding = 1e-11;  // Å: some hundred roundings of lengths below 30 Å
// Å: two searches for one place, each to the square root of rounding where a summit is flat.
constexpr double kSamePlace = 1e-7;

std::vector<Sphere> cube_corners(double edge, double radius, double x = 0) {
  std::vector<Sphere> balls;
  for (int corner = 0; corner < 8; ++corner) {
    balls.push_back(
        {{x + edge * (corner & 1), edge * (corner >> 1 & 1), edge * (corner >> 2 & 1)}, radius});
  }
  return balls;
}

std::vector<Sphere> random_balls(unsigned seed, int count, double side) {
  Dice dice(seed);
  std::vector<Sphere> balls;
  for (int i = 0; i < count; ++i) {
    balls.push_back(
        {{dice.real(0, side), dice.real(0, side), dice.real(0, side)}, dice.real(0.8, 2.2)});
  }
  return balls;
}

SphereSet grown(std::vector<Sphere> balls, double by) {
  for (Sphere& b : balls) b.radius += by;
  return SphereSet(std::move(balls));
}

double clearance(const std::vector<Sphere>& balls, const Vec3d& place) {
  double least = 1e300;
  for (const Sphere& b : balls) least = std::min(least, norm(place - b.center) - b.radius);
  return least;
}

TEST(ProbeScan, CubeOpensAtItsFaces) {
  constexpr double a = 4.6, r = 1.5;
  const ProbeScan scan = probe_scan(SphereSet(cube_corners(a, r)), 0.9, 2.9);
  ASSERT_EQ(scan.places.size(), 1u);
  EXPECT_TRUE(scan.is_complete);
  const ScanPlace& place = scan.places[0];
  EXPECT_NEAR(place.radius, std::sqrt(3.0) * a / 2 - r, kRounding);
  EXPECT_LE(norm(place.center - Vec3d{a / 2, a / 2, a / 2}), kRounding);
  ASSERT_TRUE(place.gate && place.opens_at);
  EXPECT_FALSE(place.joins);
  EXPECT_NEAR(*place.opens_at, a / std::sqrt(2.0) - r, kRounding);
  EXPECT_EQ(place.gate->radius, *place.opens_at);
  EXPECT_NEAR(norm(place.gate->center - place.center), a / 2, kRounding);
}

// A larger and a smaller chamber side by side with a square of smaller balls between: they join
// before they open.
TEST(ProbeScan, ChambersJoinBeforeTheyOpen) {
  constexpr double a = 4.6, r = 2.0, between = 1.6;
  std::vector<Sphere> balls = cube_corners(a, r);
  for (int corner = 0; corner < 8; ++corner) {
    if (corner & 1) balls[static_cast<std::size_t>(corner)].radius = between;
  }
  for (const double y : {0.0, a}) {
    for (const double z : {0.0, a}) balls.push_back({{1.8 * a, y, z}, r});
  }
  const ProbeScan scan = probe_scan(SphereSet(balls), 0.9, 2.6);
  ASSERT_EQ(scan.places.size(), 2u);
  EXPECT_GT(scan.places[0].radius, scan.places[1].radius);
  ASSERT_TRUE(scan.places[1].joins && scan.places[1].gate);
  EXPECT_EQ(*scan.places[1].joins, 0u);
  EXPECT_NEAR(scan.places[1].gate->radius, a / std::sqrt(2.0) - between, kRounding);
  EXPECT_NEAR(scan.places[1].gate->center.x, a, kRounding);
  EXPECT_LT(*scan.places[0].opens_at, scan.places[1].gate->radius);
  EXPECT_EQ(scan.places[0].opens_at, scan.places[1].opens_at);
}

// Three equal chambers in a row between squares of balls, `width` apart. A plug closes each end. As
// the squares are wider than the sides, the chambers join before they open.
std::vector<Sphere> equal_chambers(const Vec3d& corner, double length, double width, double r) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 16; ++i) {
    balls.push_back({corner + Vec3d{width * (i & 1), width * (i >> 1 & 1), length * (i / 4)}, r});
  }
  for (const double z : {-2.5, 3 * length + 2.5}) {
    balls.push_back({corner + Vec3d{width / 2, width / 2, z}, r});
  }
  return balls;
}

// Radii that are equal up to rounding: a place joins one before it all the same, and all open
// together. The numbers of the balls change nothing.
TEST(ProbeScan, EqualPlacesOpenTogether) {
  constexpr double length = 4.2, width = 5, r = 2;
  Dice dice(1);
  for (int set = 0; set < 8; ++set) {
    const Vec3d corner{dice.real(-9, 9), dice.real(-9, 9), dice.real(-9, 9)};
    std::vector<Sphere> balls = equal_chambers(corner, length, width, r);
    for (const double highest : {1.8, 2.6}) {
      std::optional<Vec3d> eldest;
      for (int numbering = 0; numbering < 3; ++numbering) {
        std::ranges::rotate(balls, balls.begin() + 5);
        const ProbeScan scan = probe_scan(SphereSet(balls), 1.2, highest);
        ASSERT_EQ(scan.places.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) {
          EXPECT_LT(scan.places[i].joins.value_or(0), std::max<std::size_t>(i, 1)) << set;
          EXPECT_EQ(scan.places[i].joins.has_value(), i > 0) << set;
          ASSERT_TRUE(scan.places[i].opens_at) << set;
          EXPECT_NEAR(*scan.places[i].opens_at, std::hypot(length, width) / 2 - r, kRounding);
        }
        if (!eldest) eldest = scan.places[0].center;
        EXPECT_EQ(scan.places[0].center, *eldest) << set;
      }
    }
  }
}

// At one radius, the places that are still apart are the voids of the dual complex, and they open
// where the search by triangulations says.
void expect_voids(const std::vector<Sphere>& balls, const ProbeScan& scan, double probe) {
  std::size_t expected = 0;
  for (const Pocket& p : pockets(grown(balls, probe)).pockets) {
    if (p.kind != PocketKind::enclosed) continue;
    ++expected;
    const auto place = std::ranges::min_element(
        scan.places, {}, [&](const ScanPlace& s) { return norm(s.center - p.clear_place); });
    ASSERT_NE(place, scan.places.end());
    if (norm(place->center - p.clear_place) > kSamePlace) continue;  // a climb that left it
    EXPECT_NEAR(place->radius, *p.clearance + probe, 1e-9);
    if (place->opens_at) {
      EXPECT_NEAR(*place->opens_at, *p.bottleneck_clearance + probe, 1e-9);
    }
  }
  const auto found = std::ranges::count_if(scan.places, [&](const ScanPlace& s) {
    return s.radius > probe && (!s.gate || s.gate->radius <= probe);
  });
  EXPECT_EQ(static_cast<std::size_t>(found), expected) << "probe " << probe;
}

TEST(ProbeScan, PlacesAreTheVoidsOfEachRadius) {
  std::size_t places = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const std::vector<Sphere> balls = random_balls(seed, 150, 14);
    const ProbeScan scan = probe_scan(SphereSet(balls), 0.2, 1.5);
    EXPECT_TRUE(scan.is_complete) << seed;
    places += scan.places.size();
    Dice dice(seed);
    for (int i = 0; i < 8; ++i) expect_voids(balls, scan, dice.real(0.2, 1.5));
  }
  EXPECT_GT(places, 100u);
}

TEST(ProbeScan, PlacesAreTheVoidsOfAProtein) {
  VDWMESH_NEEDS_SHARED("reference/1UBQ.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1UBQ.xyzr"), 0);
  const std::vector<Sphere> balls(atoms.spheres().begin(), atoms.spheres().end());
  const ProbeScan scan = probe_scan(atoms, 0.8, 3);
  EXPECT_TRUE(scan.is_complete);
  for (const double probe : {0.83, 1.0, 1.17, 1.4, 1.9}) expect_voids(balls, scan, probe);
}

TEST(ProbeScan, RefusesRanges) {
  const SphereSet cube(cube_corners(4.6, 1.5));
  EXPECT_THROW(probe_scan(cube, 2, 1), InvalidInput);
  EXPECT_THROW(probe_scan(cube, 1, std::nan("")), InvalidInput);
  EXPECT_THROW(probe_scan(cube, -1.5, 1), InvalidInput);
  EXPECT_TRUE(probe_scan(SphereSet({{{0, 0, 0}, 1}}), 0.5, 1).places.empty());
}

void expect_way(const std::vector<Sphere>& balls, const WayOut& way) {
  ASSERT_FALSE(way.points.empty());
  double along = 0;
  for (std::size_t i = 0; i < way.points.size(); ++i) {
    const WayPoint& p = way.points[i];
    if (i > 0) along += norm(p.center - way.points[i - 1].center);
    EXPECT_NEAR(p.along, along, 1e-9);
    EXPECT_NEAR(p.radius, clearance(balls, p.center), kRounding);
    EXPECT_NEAR(norm(p.center - balls[p.nearest].center) - balls[p.nearest].radius, p.radius,
                kRounding);
    // A step is far shorter than a ball, so the way nowhere leaps over one.
    if (i > 0) {
      EXPECT_LE(norm(p.center - way.points[i - 1].center), 0.2);
    }
  }
  EXPECT_NEAR(way.length, along, 1e-9);
  for (const ProbeGate& g : way.gates) {
    EXPECT_GE(g.radius, way.bottleneck);
    for (const SphereId s : g.spheres) {
      EXPECT_NEAR(norm(g.center - balls[s].center) - balls[s].radius, g.radius, kRounding);
    }
  }
}

TEST(WayOut, CubeIsLeftByAFace) {
  constexpr double a = 4.6, r = 1.5;
  const std::vector<Sphere> balls = cube_corners(a, r);
  const WayOut way = way_out(SphereSet(balls), {2.2, 2.4, 2.3});
  expect_way(balls, way);
  EXPECT_NEAR(way.bottleneck, a / std::sqrt(2.0) - r, kRounding);
  ASSERT_EQ(way.gates.size(), 1u);
  EXPECT_GE(way.points.back().radius, kOutsideProbe - kRounding);
  // Straight from the middle to where the outer probe touches the face's four balls.
  const double outward = std::sqrt(std::pow(kOutsideProbe + r, 2) - a * a / 2);
  EXPECT_NEAR(way.length, norm(Vec3d{2.2, 2.4, 2.3} - Vec3d{2.3, 2.3, 2.3}) + a / 2 + outward, 0.2);
}

// The bottleneck is that of the pocket from which the way comes, and nowhere is it narrower.
TEST(WayOut, LeavesPocketsByTheirBottlenecks) {
  std::size_t ways = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const std::vector<Sphere> balls = random_balls(seed, 150, 14);
    const std::vector<Pocket> found = pockets(grown(balls, 0.5)).pockets;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, found.size()); ++i) {
      const Pocket& p = found[i];
      if (!p.bottleneck_clearance || *p.bottleneck_clearance >= *p.clearance) continue;
      ++ways;
      const WayOut way = way_out(SphereSet(balls), p.clear_place);
      expect_way(balls, way);
      EXPECT_NEAR(way.bottleneck, *p.bottleneck_clearance + 0.5, 1e-9);
      for (const WayPoint& point : way.points) EXPECT_GE(point.radius, way.bottleneck - kRounding);
    }
  }
  EXPECT_GT(ways, 5u);
}

// From a sphere of the cube, the way begins in its middle.
TEST(WayOut, BeginsBesideASphere) {
  const SphereSet cube(cube_corners(4.6, 1.5));
  EXPECT_LE(norm(place_beside(cube, 3) - Vec3d{2.3, 2.3, 2.3}), kRounding);
  EXPECT_THROW(place_beside(SphereSet({{{0, 0, 0}, 1}}), 0), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
