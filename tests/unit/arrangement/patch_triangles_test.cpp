// Which pieces of the boundary are blamed for triangles that face inwards.
#include "arrangement/mesher/patch_triangles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

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

}  // namespace
}  // namespace vdwmesh
