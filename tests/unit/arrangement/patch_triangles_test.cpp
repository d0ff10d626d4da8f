// Which pieces of the boundary are blamed for triangles that face inwards, and which triangles have
// a small angle.
#include "creases/plane/patch_triangles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "creases/arcs/cap_margins.hpp"
#include "creases/patch/patch_mesher.hpp"
#include "creases/patch/patch_quality.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint32_t kNone = kNoPiece;

// Four points of the equator, which the pieces join, and three near the north pole.
PatchBoundary equator() {
  PatchBoundary boundary;
  boundary.points = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (std::uint32_t i = 0; i < 4; ++i) {
    boundary.pieces.push_back({i, (i + 1) % 4, 0, {0, i}, 0});
  }
  return boundary;
}

// The pieces that find_defects() names for one triangle, ascending, each once.
std::vector<std::uint32_t> defects_of(const std::array<std::uint32_t, 3>& vertices,
                                      const std::array<std::uint32_t, 3>& pieces) {
  const PatchBoundary boundary = equator();
  PatchTriangles patch;
  patch.points = boundary.points;
  for (const Vec3d& p : {Vec3d{0.6, 0, 0.8}, Vec3d{0, 0.6, 0.8}, Vec3d{-0.6, 0, 0.8}}) {
    patch.points.push_back(p);
  }
  patch.triangles = {{vertices, {kNoNeighbor, kNoNeighbor, kNoNeighbor}, pieces}};
  PatchVector<std::uint32_t> found;
  find_defects<GrowingMemory>(boundary, patch, found);
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return {found.begin(), found.end()};
}

using Pieces = std::vector<std::uint32_t>;

TEST(PatchDefects, OutwardTrianglesHaveNone) {
  EXPECT_EQ(defects_of({4, 5, 6}, {kNone, kNone, kNone}), Pieces{});
  EXPECT_EQ(defects_of({0, 1, 5}, {kNone, kNone, 0}), Pieces{});
}

TEST(PatchDefects, OfAnInwardTriangleItsOwnPieces) {
  EXPECT_EQ(defects_of({1, 0, 5}, {kNone, kNone, 0}), Pieces{0});
}

TEST(PatchDefects, OfOneWithoutPiecesThoseAtItsVertices) {
  EXPECT_EQ(defects_of({4, 5, 1}, {kNone, kNone, kNone}), (Pieces{0, 1}));
}

TEST(PatchDefects, OfOneAwayFromTheBoundaryAllPieces) {
  EXPECT_EQ(defects_of({6, 5, 4}, {kNone, kNone, kNone}), (Pieces{0, 1, 2, 3}));
}

double least_angle(const std::array<Vec3d, 3>& p) {
  double least = std::numbers::pi;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
    least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)));
  }
  return least;
}

// find_defects() looks at most triangles with a bound alone. Here the angle is computed for all:
// triangles of all sizes, most of them with an angle near the floor, at any of the three vertices.
TEST(PatchDefects, SmallAnglesAreSeenWhereverTheyAre) {
  constexpr double kDegree = std::numbers::pi / 180, kFloor = kFloorOfAngles * kDegree;
  EXPECT_DOUBLE_EQ(kFloorSine, std::sin(kFloor * (1 + kFloorMargin)));
  testing::Dice dice(7);
  const PatchBoundary boundary = equator();
  std::size_t small = 0, others = 0;
  for (int i = 0; i < 100'000; ++i) {
    // An angle at the first of three points, between sides whose lengths differ up to 20 times.
    const double size = std::pow(10, dice.real(-6, -1.5));
    const double angle = kFloor * (dice.one_in(4) ? dice.real(0, 20) : dice.real(0.9, 1.1));
    const double at = dice.real(0, 2 * std::numbers::pi),
                 side = size * std::pow(20, dice.real(0, 1));
    const Vec3d first{dice.real(-0.1, 0.1), dice.real(-0.1, 0.1), 0};
    const std::array<Vec3d, 3> flat{
        first, first + size * Vec3d{std::cos(at), std::sin(at), 0},
        first + side * Vec3d{std::cos(at + angle), std::sin(at + angle), 0}};
    const auto turned = static_cast<std::size_t>(dice.whole(0, 2));
    std::array<Vec3d, 3> p;
    PatchTriangles patch;
    patch.points = boundary.points;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& q = flat[(k + turned) % 3];
      p[k] = {q.x, q.y, std::sqrt(1 - squared_norm(q))};
      patch.points.push_back(p[k]);
    }
    // The sphere's curvature turns some long needles inwards.
    if (!(dot(p[0], cross(p[1] - p[0], p[2] - p[0])) > 0)) continue;
    const double least = least_angle(p);
    if (std::abs(least / kFloor - 1) < 1e-6) continue;  // not certain for such sizes
    patch.triangles = {{{4, 5, 6}, {kNoNeighbor, kNoNeighbor, kNoNeighbor}, {kNone, kNone, kNone}}};
    PatchVector<std::uint32_t> found;
    ASSERT_EQ(find_defects<GrowingMemory>(boundary, patch, found), least < kFloor)
        << least / kDegree << " " << size << " " << side;
    EXPECT_TRUE(found.empty());
    ++(least < kFloor ? small : others);
  }
  EXPECT_GT(small, 20'000u);
  EXPECT_GT(others, 20'000u);
}

// Those that may be clear of margins: the same points in the same order, and few others.
TEST(SpherePoints, NearAPatch) {
  testing::Dice dice(7);
  for (const double edge_length : {1.0 / 60, 1.0 / 90, 1.0 / 200}) {
    for (int i = 0; i < 8; ++i) {
      // What three caps leave: a triangle as around a probe, or a strip beside two large caps.
      std::vector<CoveredCap> caps;
      for (int k = 0; k < 3; ++k) {
        const Vec3d axis = unit({dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)});
        const double cosine = i % 2 == 0 ? 0 : dice.real(-0.9, 0.5);
        caps.push_back({axis, cosine, 2 * (1 - cosine)});
      }
      PatchVector<double> scratch;
      CapMargins<GrowingMemory> margins(caps, 0.5 * edge_length, scratch);
      const CapTree<GrowingMemory> tree(caps);
      SpherePoints all, some;
      std::vector<Vec3d> clear, clear_of_some;
      for (const Vec3d& u : all.points(edge_length)) {
        if (margins.is_clear(u, tree)) clear.push_back(u);
      }
      const std::vector<Vec3d>& near = some.points(edge_length, margins);
      for (const Vec3d& u : near) {
        if (margins.is_clear(u, tree)) clear_of_some.push_back(u);
      }
      EXPECT_EQ(clear_of_some, clear);
      if (SpherePoints::parts(edge_length) > SpherePoints::kMostPartsOfWhole) {
        const auto around = static_cast<std::size_t>(200 / edge_length);
        EXPECT_LT(near.size(), clear.size() + around);
      }
    }
  }
}

// A patch of 1e-3 of the sphere with edges of 1e-7 of it in a strip: only its own points are made.
TEST(SpherePoints, OfASmallPatchOfAHugeSphere) {
  std::vector<CoveredCap> caps;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * std::numbers::pi * k / 3;
    const Vec3d axis = unit({std::cos(turn), std::sin(turn), -1e-4});
    caps.push_back({axis, 0, 2});
  }
  PatchVector<double> scratch;
  constexpr double kEdge = 1e-6;
  const CapMargins<GrowingMemory> margins(caps, 0.5 * kEdge, scratch);
  SpherePoints points;
  EXPECT_LT(points.points(kEdge, margins).size(), 200'000u);
}

}  // namespace
}  // namespace vdwmesh
