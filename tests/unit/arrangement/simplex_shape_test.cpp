// Shapes of simplices against solid geometry, where they are regular and where they are flat.
#include "complex/simplex_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace vdwmesh {
namespace {

// Relative to lengths and angles near 1: some tens of roundings of 1.1e-16.
constexpr double kRounding = 1e-14;

const double kHeight = std::sqrt(3.0) / 2;    // of the unit triangle
const double kApex = std::sqrt(2.0 / 3);      // of the regular tetrahedron over it
const double kDihedral = std::acos(1.0 / 3);  // of the regular tetrahedron
const double kSolid = 3 * kDihedral - std::numbers::pi;
const double kVolume = std::sqrt(2.0) / 12;

TEST(SimplexShape, UnitSpheresOnARegularTriangleMeetAtTheApex) {
  const Sphere a{{0, 0, 0}, 1}, b{{1, 0, 0}, 1}, c{{0.5, kHeight, 0}, 1};
  const TriangleShape t = triangle_shape(a, b, c);
  const CornerShape corner = corner_shape(a, b, c, t);
  EXPECT_NEAR(t.twice_area, kHeight, kRounding);
  EXPECT_NEAR(t.half_chord, kApex, kRounding);
  EXPECT_NEAR(corner.volume, kVolume, kRounding);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(t.distance[k], kHeight / 3, kRounding);
    EXPECT_NEAR(corner.dihedral[k], kDihedral, kRounding);
    EXPECT_NEAR(corner.solid_angle[k], kSolid, kRounding);
  }
  const CommonPoints points = common_points(a, b, c);
  EXPECT_NEAR(norm(points.above - Vec3d{0.5, kHeight / 3, kApex}), 0, kRounding);
  EXPECT_NEAR(norm(points.below - Vec3d{0.5, kHeight / 3, -kApex}), 0, kRounding);
}

// The circle through the centres has the squared radius side² / 3, less what balls take of it.
TEST(SimplexShape, SizeOfATriangle) {
  for (const double r : {1.0, 0.25}) {
    const Sphere a{{0, 0, 0}, r}, b{{1, 0, 0}, r}, c{{0.5, kHeight, 0}, r};
    EXPECT_NEAR(orthogonal_size(a, b, c), 1.0 / 3 - r * r, kRounding);
  }
  // Sides 3, 4, 5: the circle has half of the longest as its radius, and balls all but reach its
  // centre.
  const double r = 0.625 - 0x1p-40;
  EXPECT_NEAR(
      orthogonal_size({{0, 0, 0}, r}, {{0.75, 0, 0}, r}, {{0, 1, 0}, r}) / ((0.625 + r) * 0x1p-40),
      1, kRounding);
  // Thin: the circle through 0, 1 and the middle lifted by e has the radius (1/4 + e²) / 2e.
  const double lift = 0x1p-40, radius = (0.25 + lift * lift) / (2 * lift);
  const double size = orthogonal_size({{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0.5, lift, 0}, 1});
  EXPECT_NEAR(size / (radius * radius), 1, kRounding);
}

TEST(SimplexShape, RegularTetrahedron) {
  const std::array<Sphere, 4> balls{
      {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0.5, kHeight, 0}, 1}, {{0.5, kHeight / 3, kApex}, 1}}};
  const TetrahedronShape t = tetrahedron_shape(balls);
  EXPECT_NEAR(t.volume, kVolume, kRounding);
  for (const double angle : t.dihedral) EXPECT_NEAR(angle, kDihedral, kRounding);
  for (const double angle : t.solid_angle) EXPECT_NEAR(angle, kSolid, kRounding);
  for (const double height : t.center_height) EXPECT_NEAR(height, kApex / 4, kRounding);
  EXPECT_NEAR(norm(orthogonal_center(balls) - Vec3d{0.5, kHeight / 3, kApex / 4}), 0, kRounding);
}

// A square with one corner lifted by e: the circumcentre is e / 2 above the square's. The side has
// 30 bits, so its square rounds in double, and a double centre would be off by 1e-16 / e.
TEST(SimplexShape, FlatTetrahedronKeepsItsCenter) {
  const double side = 1.1 - std::remainder(1.1, 0x1p-30), lift = 0x1p-40;
  const std::array<Sphere, 4> balls{
      {{{0, 0, 0}, 1}, {{side, 0, 0}, 1}, {{0, side, 0}, 1}, {{side, side, lift}, 1}}};
  const TetrahedronShape t = tetrahedron_shape(balls);
  EXPECT_NEAR(t.center_height[3], lift / 2, kRounding);
  EXPECT_NEAR(norm(orthogonal_center(balls) - Vec3d{side / 2, side / 2, lift / 2}), 0, kRounding);
}

// Three spheres through the unit circle in x = 0 but for a lift of the middle one by e: the common
// points stay on that circle, wherever on it the rounded radii put them.
TEST(SimplexShape, ThinTriangleKeepsItsChord) {
  const double lift = 0x1p-40, r = std::sqrt(2.0);
  const TriangleShape t =
      triangle_shape({{-1, 0, 0}, r}, {{1, 0, 0}, r}, {{0, lift, 0}, std::sqrt(1 + lift * lift)});
  EXPECT_NEAR(t.twice_area, 2 * lift, kRounding * lift);
  EXPECT_NEAR(t.half_chord * t.half_chord + t.distance[2] * t.distance[2], 1, kRounding);
}

// The shapes of simplices far smaller than the spheres are those of their angles alone.
TEST(SimplexShape, NothingUnderflows) {
  for (const double size : {1e-20, 1e-40, 1e-100, 1e-170, 1e-300}) {
    SCOPED_TRACE(size);
    const double h = kHeight * size;
    const Sphere a{{0, 0, 0}, 1}, b{{size, 0, 0}, 1}, c{{size / 2, h, 0}, 1},
        d{{size / 2, h / 3, kApex * size}, 1};
    const EdgeShape e = edge_shape(a, b);
    EXPECT_NEAR(e.length / size, 1, kRounding);
    EXPECT_NEAR(e.height[0] / size, 0.5, kRounding);
    EXPECT_NEAR(e.squared_circle_radius, 1, kRounding);
    const TriangleShape t = triangle_shape(a, b, c);
    EXPECT_NEAR(t.half_chord, 1, kRounding);
    for (const double distance : t.distance) EXPECT_NEAR(distance / h, 1.0 / 3, kRounding);
    const CommonPoints points = common_points(a, b, c);
    EXPECT_NEAR(points.above.z, 1, kRounding);
    EXPECT_NEAR(points.below.z, -1, kRounding);
    // A needle over the triangle: right angles at the base, which leave its own angles.
    const CornerShape corner = corner_shape(a, b, c, t);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(corner.dihedral[k], std::numbers::pi / 2, kRounding);
      EXPECT_NEAR(corner.solid_angle[k], std::numbers::pi / 3, kRounding);
    }
    const TetrahedronShape tetrahedron = tetrahedron_shape({a, b, c, d});
    for (const double angle : tetrahedron.dihedral) EXPECT_NEAR(angle, kDihedral, kRounding);
    for (const double angle : tetrahedron.solid_angle) EXPECT_NEAR(angle, kSolid, kRounding);
    for (const double height : tetrahedron.center_height) {
      EXPECT_NEAR(height / size, kApex / 4, kRounding);
    }
    const Vec3d center = orthogonal_center({a, b, c, d});
    EXPECT_NEAR(center.z / size, kApex / 4, kRounding);
  }
}

// Two balls on opposite sides of a third but for 2⁻²⁵⁰, all through a point at right angles: on the
// middle one they and that point span half a hemisphere. Its tangent is the quotient of a product
// as small as that and a difference as small as its square, of numbers of size 1.
TEST(SimplexShape, RootsHaveAllHundredDigits) {
  const double lift = 0x1p-250;
  const Sphere a{{0, 0, 0}, 1}, b{{0.75, 0, 0}, 1.25}, c{{-0.75, lift, 0}, 1.25};
  const TriangleShape t = triangle_shape(a, b, c);
  EXPECT_NEAR(t.half_chord, 1, kRounding);
  EXPECT_NEAR(corner_shape(a, b, c, t).solid_angle[0], std::numbers::pi, kRounding);
}

// Ball b touches a from inside in a point x that c passes through. They have x alone in common, on
// the line ab beyond b. The tetrahedron of a, b, c and x is flat, and no solid angle of it is 2 π.
TEST(SimplexShape, CornersWhereTwoBallsTouch) {
  const Sphere a{{-2.5, 1, -2}, 2}, b{{-2, 1, -2}, 1.5}, c{{-0.5, -1.5, -2}, 2.5};
  for (const auto& [p, q, o] : {std::array{a, b, c}, {b, c, a}, {c, a, b}, {b, a, c}}) {
    const TriangleShape t = triangle_shape(p, q, o);
    EXPECT_EQ(t.half_chord, 0);
    for (const double angle : corner_shape(p, q, o, t).solid_angle) EXPECT_EQ(angle, 0);
  }
}

}  // namespace
}  // namespace vdwmesh
