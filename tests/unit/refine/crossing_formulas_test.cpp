// Pairs of triangles that do and do not pass through each other.
#include "refine/crossings/crossing_formulas.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

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

// Edges of both lie in one line, a part of it apart, as after two subdivisions of a straight edge.
// Rounded volumes are not zero there: without bounds of their errors the two would cross.
TEST(TrianglesCross, NotByRounding) {
  const Corners s{{{0.77769285615227413, 3.4998361738572994, 0.48330780957114017},
                   {0.83193583630245194, 3.4769564794078085, 0.49550225872907522},
                   {0.77769285615227413, 3.5052628643268875, 0.48180371239373165}}},
      t{{{0.77769285615227413, 3.4889827929181232, 0.4863160039259572},
         {0.77769285615227413, 3.4944094833877113, 0.48481190674854868},
         {0.75435490169315333, 3.5393670966154085, 0.51740851142123934}}};
  EXPECT_FALSE(cross_each_other(s, kFlatVertices, t, {3, 4, 5}));
}

// A segment that pierces a triangle in its edge, or misses it by the last bit: only exact volumes
// tell. The plane is z = 0, the edge runs from (0, 0) to (1, 3), and a third of it has no double.
TEST(TrianglesCross, DecidesExactlyAtAnEdge) {
  const double x = 1.0 / 3;  // less than a third, so (x, 1) lies on the left of the edge
  const Corners right{{{0, 0, 0}, {1, 3, 0}, {4, 0, 0}}}, left{{{0, 0, 0}, {1, 3, 0}, {-4, 0, 0}}};
  const auto needle = [](double at) { return Corners{{{at, 1, -1}, {at, 1, 1}, {at, 1, 2}}}; };
  EXPECT_FALSE(cross_each_other(right, kFlatVertices, needle(x), {3, 4, 5}));
  EXPECT_TRUE(cross_each_other(left, kFlatVertices, needle(x), {3, 4, 5}));
  const double next = std::nextafter(x, 1);
  EXPECT_TRUE(cross_each_other(right, kFlatVertices, needle(next), {3, 4, 5}));
  EXPECT_FALSE(cross_each_other(left, kFlatVertices, needle(next), {3, 4, 5}));
  EXPECT_TRUE(
      cross_each_other({{{0, 0, 0}, {1, 2, 0}, {4, 0, 0}}}, kFlatVertices, needle(0.5), {3, 4, 5}));
}

// A tetrahedron over three corners of a cube far off, and what a step of the last bit does to it.
TEST(ExactOrientation, TellsTheLastBit) {
  const double far = 1e8;
  const Vec3d a{far, 0, 0}, b{far + 1, 0, 1}, c{far, 1, 1};
  const Vec3d d{far + 1.0 / 3, 1.0 / 3, 2.0 / 3};  // rounded: far + 1/3 is too large or too small
  // n = (b - a) × (c - a) = (-1, -1, 1), so the volume is (d.z - d.y) - (d.x - far).
  const double exact = (2.0 / 3 - 1.0 / 3) - ((far + 1.0 / 3) - far);
  ASSERT_NE(exact, 0);
  EXPECT_EQ(exact_orientation(a, b, c, d), exact > 0 ? 1 : -1);
  EXPECT_EQ(exact_orientation(b, a, c, d), exact > 0 ? -1 : 1);
  EXPECT_EQ(exact_orientation(a, b, c, {far + 0.25, 0.25, 0.5}), 0);
  EXPECT_EQ(exact_orientation(a, b, c, {far + 0.25, 0.25, std::nextafter(0.5, 1)}), 1);
}

}  // namespace
}  // namespace vdwmesh
