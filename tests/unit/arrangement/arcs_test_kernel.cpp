// The per-ball routine by itself: that it doubts what it should, and only that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "measures/arcs/cut_ball.hpp"

namespace vdwmesh::arcs {
namespace {

BallMeasures measure(std::vector<Cap> caps) { return CutBall().measure(caps); }

Cap cap(double x, double y, double z, double cosine) {
  const double length = std::sqrt(x * x + y * y + z * z);
  return {{x / length, y / length, z / length}, cosine};
}

// Three walls of a prism about the z axis, at distance t.
std::vector<Cap> prism(double t) {
  const double s = std::sqrt(3.0);
  return {cap(2, 0, 0, t), cap(-1, s, 0, t), cap(-1, -s, 0, t)};
}

TEST(ArcKernel, ConcentricBallsAreBuriedByLargerOnesAlone) {
  const Sphere ball{{1, 2, 3}, 1.5};
  Cap unused;
  EXPECT_EQ(make_cap(ball, {ball.center, 1.6}, unused), CapKind::buries);
  EXPECT_EQ(make_cap(ball, {ball.center, 1.4}, unused), CapKind::none);
  EXPECT_EQ(make_cap(ball, ball, unused), CapKind::none);  // else both would be lost
}

// CapOrder compares keys of fewer bits first and puts right what they leave in disorder. Near ties
// differ by less than a step of a key; the sizes stand around a vector of keys and around the limit
// above which it sorts by comparisons alone.
TEST(ArcKernel, CapOrderIsThatOfSortingByComparisons) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> wide(-1, 1), narrow(0, 1e-7);
  CapOrder order;
  for (const std::size_t size : {0, 1, 2, 7, 8, 9, 15, 16, 17, 127, 128, 129, 300}) {
    for (const double spread : {1.0, 0.0}) {
      std::vector<Cap> caps;
      for (std::size_t i = 0; i < size; ++i) {
        caps.push_back(
            cap(wide(random), wide(random), wide(random), spread * wide(random) + narrow(random)));
        if (i % 5 == 4) caps.back().cosine = caps[i - 2].cosine;  // the axes decide
      }
      std::vector<Cap> sorted = caps;
      std::ranges::sort(sorted, cuts_deeper);
      const std::span<const std::uint32_t> found = order.sort(caps);
      ASSERT_EQ(found.size(), size);
      for (std::size_t i = 0; i < size; ++i) {
        ASSERT_TRUE(same_cap(caps[found[i]], sorted[i])) << size << " caps, place " << i;
      }
    }
  }
}

// Beside those of the C library, which has them right to the last place or nearly so. All octants,
// axes, diagonals, tiny angles beside the axes, and the bounds of the replaced ratios.
TEST(ArcKernel, ArgumentsAreThoseOfTheLibrary) {
  constexpr double kPlaces = 4 * std::numeric_limits<double>::epsilon();  // of the angle
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> wide(-1, 1), exponent(-90, 90);
  std::vector<std::pair<double, double>> numbers;  // im, re
  for (int i = 0; i < 20000; ++i) {
    const double size = std::pow(10, exponent(random));
    numbers.push_back({size * wide(random), size * wide(random)});
    numbers.push_back({size * wide(random) * 1e-12, size * wide(random)});
    numbers.push_back({size * wide(random), size * wide(random) * 1e-12});
  }
  for (const double tangent : {0.0, std::tan(std::numbers::pi / 8), 1.0}) {
    for (const double shift : {-1e-15, 0.0, 1e-15}) {
      for (const double x : {-1.0, 1.0}) {
        for (const double y : {-tangent - shift, tangent + shift}) {
          numbers.insert(numbers.end(), {{y, x}, {x, y}});
        }
      }
    }
  }
  for (const auto& [im, re] : numbers) {
    const double angle = std::atan2(im, re),
                 expected = angle < 0 ? angle + 2 * std::numbers::pi : angle;
    const Lanes found = arguments(all_lanes(re), all_lanes(im));
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      ASSERT_NEAR(found[lane], expected, kPlaces * std::max(expected, 1e-300)) << re << ' ' << im;
    }
  }
}

TEST(ArcKernel, OctantOfTheBall) {
  const BallMeasures m = measure({cap(1, 0, 0, 0), cap(0, 1, 0, 0), cap(0, 0, 1, 0)});
  EXPECT_EQ(m.doubts, 0u);
  EXPECT_NEAR(m.area, std::numbers::pi / 2, 1e-14);
  EXPECT_NEAR(m.volume, std::numbers::pi / 6, 1e-14);
}

TEST(ArcKernel, CubeInsideTheBall) {
  std::vector<Cap> caps;
  for (const double side : {-1.0, 1.0}) {
    caps.insert(caps.end(), {cap(side, 0, 0, 0.5), cap(0, side, 0, 0.5), cap(0, 0, side, 0.5)});
  }
  const BallMeasures m = measure(caps);
  EXPECT_EQ(m.doubts, 0u);
  EXPECT_EQ(m.area, 0);
  EXPECT_NEAR(m.volume, 1, 1e-14);
}

TEST(ArcKernel, WedgeAndItsComplementFillTheBall) {
  for (const double angle : {0.1, 1.0, 2.0, 3.0}) {
    const Cap a = cap(0, -1, 0, 0), b = cap(-std::sin(angle), std::cos(angle), 0, 0);
    const BallMeasures m = measure({a, b});
    EXPECT_NEAR(m.area, 2 * angle, 1e-13) << angle;
    EXPECT_NEAR(m.volume, 2 * angle / 3, 1e-13) << angle;
  }
}

TEST(ArcKernel, EmptinessIsDoubtedOnlyWhereItIsClose) {
  EXPECT_EQ(measure(prism(0.01)).doubts, 0u);
  EXPECT_NE(measure(prism(0)).doubts, 0u);
  const BallMeasures empty = measure(prism(-0.01));
  EXPECT_EQ(empty.doubts, 0u);
  EXPECT_EQ(empty.area, 0);
  EXPECT_EQ(empty.volume, 0);
}

// The circles of the first two cross at (0, 0, 1); the third passes it at distance `room`.
TEST(ArcKernel, AThirdCircleIsDoubtedOnlyWhereItIsClose) {
  for (const double room : {1e-5, 1e-7, -1e-7, -1e-5}) {
    EXPECT_EQ(
        measure({cap(3, 0, 4, 0.8), cap(0, 3, 4, 0.8), cap(-2, -1, 4, 4 / std::sqrt(21.0) + room)})
            .doubts,
        0u)
        << room;
  }
  for (const double room : {1e-11, 1e-13, 0.0, -1e-13, -1e-11}) {
    EXPECT_NE(
        measure({cap(3, 0, 4, 0.8), cap(0, 3, 4, 0.8), cap(-2, -1, 4, 4 / std::sqrt(21.0) + room)})
            .doubts,
        0u)
        << room;
  }
}

// The second cap covers half of the first one's circle, the third the other half but for two arcs.
TEST(ArcKernel, ArcsThatAllButVanishAreDoubted) {
  const double s = std::sqrt(0.75);
  const auto doubts = [&](double arc) {
    return measure({cap(0, 0, 1, 0.5), cap(1, 0, 0, 0),
                    cap(-1, 0, 1, (s * arc + 0.5) / std::sqrt(2.0))})
        .doubts;
  };
  EXPECT_EQ(doubts(1e-5), 0u);
  EXPECT_TRUE(doubts(1e-10) & kTinyArc);
}

TEST(ArcKernel, PlanesThatAllButCoincideAreDoubted) {
  EXPECT_EQ(measure({cap(1, 2, 3, 0.5), cap(1, 2, 3, 0.5)}).doubts, 0u);  // equal: one plane
  EXPECT_NE(measure({cap(1, 2, 3, 0.5), cap(1, 2, 3 + 1e-10, 0.5)}).doubts, 0u);
  EXPECT_NE(measure({cap(1, 2, 3, 0.5), cap(-1, -2, -3, -0.5 + 1e-10)}).doubts, 0u);
}

TEST(ArcKernel, WhatIsNotANumberIsDoubted) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  const Cap good = cap(1, 2, 3, 0.5);
  for (const Cap& bad : {Cap{{1, 0, 0}, nan}, Cap{{nan, 0, 0}, nan}, Cap{{1, 0, 0}, infinity}}) {
    EXPECT_TRUE(measure({bad}).doubts & kNotFinite);
    EXPECT_NE(measure({good, bad}).doubts, 0u);
    EXPECT_NE(measure({bad, good}).doubts, 0u);
  }
}

// Balls nearer to each other than any square of a double can say.
TEST(ArcKernel, CapsOfCentresNextToNothingApart) {
  for (const double apart : {1e-100, 1e-139, 1e-141, 1e-160, 1e-170, 1e-300, 5e-324}) {
    Cap found{};
    ASSERT_EQ(make_cap({{0, 0, 0}, 1}, {{0, apart, 0}, 1}, found), CapKind::cuts) << apart;
    EXPECT_NEAR(norm(found.axis - Vec3d{0, 1, 0}), 0, 1e-15);
    EXPECT_NEAR(found.cosine, apart / 2, 1e-15 * apart);
    EXPECT_EQ(make_cap({{0, 0, 0}, 1}, {{0, apart, 0}, 1.5}, found), CapKind::buries) << apart;
    EXPECT_EQ(make_cap({{0, 0, 0}, 1.5}, {{0, apart, 0}, 1}, found), CapKind::none) << apart;
  }
}

// The corners of the octant: three arcs of a quarter turn, one patch.
TEST(ArcKernel, CountsOfThePatch) {
  const BallMeasures octant = measure({cap(1, 0, 0, 0), cap(0, 1, 0, 0), cap(0, 0, 1, 0)});
  EXPECT_EQ(octant.corners, 3u);
  EXPECT_EQ(octant.euler_characteristic, 1);
  const BallMeasures annulus = measure({cap(1, 2, 3, 0.5), cap(-1, -2, -3, 0.5)});
  EXPECT_EQ(annulus.corners, 0u);
  EXPECT_EQ(annulus.euler_characteristic, 0);
  const BallMeasures whole = measure({});
  EXPECT_EQ(whole.euler_characteristic, 2);
  EXPECT_DOUBLE_EQ(whole.area, 4 * std::numbers::pi);
}

// Three small caps far from one another: a sphere with three holes.
TEST(ArcKernel, DisksThatMeetNothingAreHoles) {
  const double t = 0.9;
  const BallMeasures m = measure({cap(1, 0, 0, t), cap(0, 1, 0, t), cap(0, 0, 1, t)});
  EXPECT_EQ(m.doubts, 0u);
  EXPECT_EQ(m.euler_characteristic, 2 - 3);
  const double kPi = std::numbers::pi;
  EXPECT_NEAR(m.area, 4 * kPi - 3 * 2 * kPi * (1 - t), 1e-14);
  const double hidden = kPi * (1 - t) * (1 - t) * (2 + t) / 3;
  EXPECT_NEAR(m.volume, 4 * kPi / 3 - 3 * hidden, 1e-14);
}

// Caps of one size on all sides, cut in any order, leave a polytope or islands of the sphere.
// Twelve caps about the vertices of an icosahedron: islands about its 20 faces if their circles
// cross, one island with 12 holes if not.
TEST(ArcKernel, IslandsOfAnIcosahedron) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  const auto caps = [&](double t) {
    std::vector<Cap> all;
    for (const double u : {-1.0, 1.0}) {
      for (const double v : {-g, g}) {
        all.insert(all.end(), {cap(0, u, v, t), cap(u, v, 0, t), cap(v, 0, u, t)});
      }
    }
    return all;
  };
  const double edge = std::sqrt((1 + 1 / std::sqrt(5.0)) / 2);   // cosine of half a side
  const double face = std::sqrt((5 + 2 * std::sqrt(5.0)) / 15);  // of a face's circumradius
  const BallMeasures holes = measure(caps(edge + 0.01));
  EXPECT_EQ(holes.doubts, 0u);
  EXPECT_EQ(holes.euler_characteristic, 2 - 12);
  EXPECT_EQ(holes.corners, 0u);
  const BallMeasures islands = measure(caps((edge + face) / 2));
  EXPECT_EQ(islands.doubts, 0u);
  EXPECT_EQ(islands.euler_characteristic, 20);
  EXPECT_EQ(islands.corners, 60u);
  const BallMeasures closed = measure(caps(face - 0.01));
  EXPECT_EQ(closed.area, 0);
  // A dodecahedron of this inradius: volume = inradius³ · 10 sqrt(130 - 58 sqrt 5).
  const double t = face - 0.01;
  EXPECT_NEAR(closed.volume, t * t * t * 10 * std::sqrt(130 - 58 * std::sqrt(5.0)), 1e-13);
}

}  // namespace
}  // namespace vdwmesh::arcs
