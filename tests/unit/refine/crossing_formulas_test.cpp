// Pairs of triangles that do and do not pass through each other.
#include "refine/crossing_formulas.hpp"

#include <gtest/gtest.h>

#include <array>

namespace vdwmesh {
namespace {

using Corners = std::array<Vec3d, 3>;
using Vertices = std::array<std::uint32_t, 3>;
using Atoms = std::array<SphereId, 3>;

constexpr Atoms kOne{5, 5, 5}, kTwo{5, 5, 6};

bool cross_each_other(const Corners& s, const Vertices& vs, const Corners& t, const Vertices& vt,
                      const Atoms& as = kTwo, const Atoms& at = kTwo) {
  const auto test = [&](const Corners& a, const Vertices& va, const Atoms& aa, const Corners& b,
                        const Vertices& vb, const Atoms& ab) {
    return boxes_overlap(a.data(), b.data()) &&
           triangles_cross(a.data(), va.data(), aa.data(), b.data(), vb.data(), ab.data());
  };
  const bool forwards = test(s, vs, as, t, vt, at);
  EXPECT_EQ(test(t, vt, at, s, vs, as), forwards);
  return forwards;
}

constexpr Corners kFlat{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
constexpr Vertices kFlatVertices{0, 1, 2};

TEST(TrianglesCross, WhereAnEdgePierces) {
  EXPECT_TRUE(
      cross_each_other(kFlat, kFlatVertices, {{{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}}, {3, 4, 5}));
  EXPECT_TRUE(
      cross_each_other(kFlat, kFlatVertices, {{{-1, 1, -1}, {-1, 1, 3}, {3, 1, 1}}}, {3, 4, 5}));
  EXPECT_TRUE(cross_each_other(kFlat, kFlatVertices, {{{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}},
                               {3, 4, 5}, kOne, kOne));
}

TEST(TrianglesCross, NotWhereTheyAreApart) {
  EXPECT_FALSE(
      cross_each_other(kFlat, kFlatVertices, {{{1, 1, 1}, {1, 1, 2}, {2, 2, 1}}}, {3, 4, 5}));
  EXPECT_FALSE(
      cross_each_other(kFlat, kFlatVertices, {{{3, 3, -1}, {3, 3, 1}, {9, 9, 0}}}, {3, 4, 5}));
  EXPECT_FALSE(cross_each_other(kFlat, kFlatVertices, {{{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}},
                                {3, 4, 5}));  // in one plane
}

TEST(TrianglesCross, AroundASharedVertexUnlessOfOneAtom) {
  const Corners folded{{{0, 0, 0}, {1, 2, -1}, {2, 1, 1}}},
      beside{{{0, 0, 0}, {-1, 2, 1}, {-2, 1, 1}}};
  EXPECT_TRUE(cross_each_other(kFlat, kFlatVertices, folded, {0, 3, 4}));
  EXPECT_TRUE(cross_each_other(kFlat, kFlatVertices, folded, {0, 3, 4}, kOne, kTwo));
  EXPECT_FALSE(cross_each_other(kFlat, kFlatVertices, folded, {0, 3, 4}, kOne, kOne));
  EXPECT_FALSE(cross_each_other(kFlat, kFlatVertices, beside, {0, 3, 4}));
}

TEST(TrianglesCross, NotAcrossASharedEdge) {
  EXPECT_FALSE(
      cross_each_other(kFlat, kFlatVertices, {{{0, 0, 0}, {4, 0, 0}, {1, 1, 1}}}, {0, 1, 3}));
}

}  // namespace
}  // namespace vdwmesh
