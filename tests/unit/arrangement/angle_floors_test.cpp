// Which angles count as below their floor. Here all are inside of a patch, where the floor is 5°
// and no arc matters.
#include "creases/patch/angle_floors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "creases/patch/patch_quality.hpp"

namespace vdwmesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A triangle with this angle (rad) at its vertex `apex`, which is a pole of the sphere. Its sides
// there lead to points of latitude pi / 2 - t, so they dip below the horizon by t / 2. If the
// meridians of these points are φ apart, sin(angle / 2) = cos(t / 2) sin(φ / 2).
PatchTriangles needle(double angle, std::uint32_t apex) {
  constexpr double kSide = 0.1;
  const double half = std::asin(std::sin(angle / 2) / std::cos(kSide / 2));
  const auto at = [&](double meridian) {
    return Vec3d{std::sin(kSide) * std::cos(meridian), std::sin(kSide) * std::sin(meridian),
                 std::cos(kSide)};
  };
  PatchTriangles patch;
  patch.points.resize(3);
  patch.points[apex] = {0, 0, 1};
  patch.points[(apex + 1) % 3] = at(-half);
  patch.points[(apex + 2) % 3] = at(half);
  patch.triangles = {
      {{0, 1, 2}, {kNoNeighbor, kNoNeighbor, kNoNeighbor}, {kNoPiece, kNoPiece, kNoPiece}}};
  return patch;
}

std::uint64_t count_below(const PatchTriangles& patch) {
  const BoundaryArcs no_arcs;
  const ArcSampling sampling(no_arcs, {});
  const SplitLimits limits({}, no_arcs, sampling);
  const PatchBoundary boundary;
  const AngleFloors floors(boundary, {no_arcs, sampling, limits, 0, 1}, 0.3);
  EXPECT_EQ(floors.has_angle_below(patch), floors.count(patch) > 0);
  return floors.count(patch);
}

// An angle above its floor by less than kFloorMargin might be below it in the mesh, so it counts.
// The mesher counts only patches in which find_defects() has seen a small angle, so this must see
// what counts.
TEST(AngleFloors, AnAngleCountsUntilItIsTheMarginAboveItsFloor) {
  struct Case {
    double above;  // the angle is (1 + above) times the floor
    std::uint64_t count;
  };
  for (const Case& c : {Case{-0.5, 1}, Case{-1e-6, 1}, Case{-0.5 * kFloorMargin, 1}, Case{0, 1},
                        Case{0.5 * kFloorMargin, 1}, Case{0.99 * kFloorMargin, 1},
                        Case{1.01 * kFloorMargin, 0}, Case{1e-6, 0}, Case{1, 0}}) {
    for (std::uint32_t apex = 0; apex < 3; ++apex) {
      SCOPED_TRACE(::testing::Message() << c.above << ", vertex " << apex);
      const PatchTriangles patch = needle((1 + c.above) * kFloorOfAngles * kDegree, apex);
      EXPECT_EQ(count_below(patch), c.count);
      PatchVector<std::uint32_t> found;
      EXPECT_EQ(find_defects<GrowingMemory>(PatchBoundary{}, patch, found), c.count > 0);
    }
  }
}

// The pieces of a polygon and of one chord across it, by a look at all of them.
TEST(PieceChords, LongestAtVerticesIsTheFirstOfTheLongest) {
  PatchBoundary boundary;
  for (const double angle : {0.0, 0.3, 0.6, 1.2, 1.5, 1.8, 2.4, 2.7}) {
    boundary.points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  const auto count = static_cast<std::uint32_t>(boundary.points.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    boundary.pieces.push_back({i, (i + 1) % count, 0, {0, i}, 0});
  }
  boundary.pieces.push_back({4, 1, 1, {1, 0}, 0});
  const PieceChords chords{boundary};
  for (std::uint32_t a = 0; a < count; ++a) {
    for (std::uint32_t b = 0; b < count; ++b) {
      const LinkedTriangle t{{a, b, count + 5}, {}, {}};
      for (const std::uint32_t but : {kNoPiece, 2u, 7u}) {
        std::uint32_t expected = kNoPiece;
        for (std::uint32_t p = 0; p < boundary.pieces.size(); ++p) {
          const BoundaryPiece& piece = boundary.pieces[p];
          const bool ends_there =
              piece.from == a || piece.to == a || piece.from == b || piece.to == b;
          if (!ends_there || p == but) continue;
          if (expected == kNoPiece || chords.of(p) > chords.of(expected)) expected = p;
        }
        EXPECT_EQ(chords.longest_at_vertices(t, but), expected) << a << ' ' << b << ' ' << but;
      }
    }
  }
}

}  // namespace
}  // namespace vdwmesh
