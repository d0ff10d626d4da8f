// The per-ball routine by itself: that it doubts what it should, and only that.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "arrangement/arcs/arc_kernel.hpp"

namespace vdwmesh::arcs {
namespace {

struct Space {
  std::vector<CellFace> faces = std::vector<CellFace>(32);
  std::vector<std::uint32_t> active = std::vector<std::uint32_t>(32);
  std::vector<CellEdge> edges = std::vector<CellEdge>(96);
  std::vector<Cap> nudged = std::vector<Cap>(32);
  ArcWorkspace workspace(std::uint32_t face_capacity = 32, std::uint32_t edge_capacity = 96) {
    return {faces.data(), active.data(), face_capacity, edges.data(), edge_capacity, nudged.data()};
  }
};

BallMeasures measure(std::vector<Cap> caps, std::uint32_t face_capacity = 32,
                     std::uint32_t edge_capacity = 96) {
  Space space;
  return measure_ball(caps.data(), static_cast<std::uint32_t>(caps.size()),
                      space.workspace(face_capacity, edge_capacity));
}

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

// Each attempt moves the planes from where they are, not from where the last one left them.
TEST(ArcKernel, NudgesStayWithinTheirBound) {
  constexpr double kRounding = 1e-16;
  const std::vector<Cap> caps(16, cap(1, 2, 3, 0.5));
  std::vector<Cap> nudged = caps;
  for (std::uint64_t attempt = 0; attempt < kNudges; ++attempt) {
    nudge_caps(caps.data(), 16, attempt, nudged.data());
    for (const Cap& moved : nudged) {
      EXPECT_LE(std::abs(moved.cosine - 0.5), kNudge + kRounding) << attempt;
    }
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

TEST(ArcKernel, SmallWorkspaceIsReportedNotOverrun) {
  const std::vector<Cap> caps{cap(1, 0, 0, 0), cap(0, 1, 0, 0), cap(0, 0, 1, 0)};
  EXPECT_TRUE(measure(caps, 2, 96).doubts & kOverflow);
  EXPECT_TRUE(measure(caps, 32, 2).doubts & kOverflow);
  EXPECT_EQ(measure(caps, 3, 3).doubts, 0u);
}

// Each kind of damage to the edges of a good cell is seen.
class Damage : public ::testing::Test {
 protected:
  Damage() {
    std::sort(caps_.begin(), caps_.end(), cuts_deeper);
    for (const Cap& c : caps_) cell_.cut(c);
  }
  std::uint32_t doubts() const { return measure_cell(cell_, caps_.data(), 4).doubts; }
  CellEdge& exposed_edge() {
    std::uint32_t i = 0;
    while (cell_.edge(i).exposed != kUpperEnd && cell_.edge(i).exposed != kLowerEnd) ++i;
    return cell_.edge(i);
  }

  Space space_;
  std::vector<Cap> caps_{cap(1, 0.1, 0.2, 0.3), cap(0.1, 1, -0.1, 0.35), cap(0, 0.2, 1, 0.25),
                         cap(-0.3, -0.2, -1, 0.9)};
  BallCell cell_{space_.workspace(), EdgeEnding::direct};
};

TEST_F(Damage, NoneIsFine) { EXPECT_EQ(doubts(), 0u); }

TEST_F(Damage, LostCorner) {
  exposed_edge().exposed = 0;
  EXPECT_TRUE(doubts() & kGaussBonnet);
  EXPECT_TRUE(doubts() & kOpenSurface);
}

TEST_F(Damage, MovedCorner) {
  CellEdge& edge = exposed_edge();
  edge.root *= 1 + 1e-9;
  EXPECT_TRUE(doubts() & kGaussBonnet);
}

TEST_F(Damage, ShortenedEdge) {
  CellEdge& edge = exposed_edge();
  (edge.exposed == kUpperEnd ? edge.lower : edge.upper) *= 0.999;
  EXPECT_TRUE(doubts() & kOpenSurface);
}

}  // namespace
}  // namespace vdwmesh::arcs
