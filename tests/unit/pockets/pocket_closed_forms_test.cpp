// Pockets between the corners of a cube and of an icosahedron, against formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "core/errors.hpp"
#include "pockets/pockets.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;
// Some hundred roundings of figures below 120.
constexpr double kRounding = 1e-11;

// What two balls of radius R at distance d have in common, and its section through both centres.
struct LensForm {
  double radius, distance;
  double top() const { return radius - distance / 2; }
  double volume() const { return 2 * kPi * top() * top() * (3 * radius - top()) / 3; }
  double area() const { return 4 * kPi * radius * top(); }
  double angle() const { return std::acos(distance / 2 / radius); }
  double section() const {
    const double half = distance / 2;
    return 2 * (angle() * radius * radius - half * std::sqrt(radius * radius - half * half));
  }
};

std::vector<Sphere> cube_corners(double edge, double radius) {
  std::vector<Sphere> balls;
  for (int corner = 0; corner < 8; ++corner) {
    balls.push_back(
        {{edge * (corner & 1), edge * (corner >> 1 & 1), edge * (corner >> 2 & 1)}, radius});
  }
  return balls;
}

// A corner of the cube has an eighth of a ball, an edge a quarter of a lens, a face its half.
TEST(PocketClosedForms, CubeHasAMouthInEachFace) {
  constexpr double a = 4.6, r = 2.9;
  const LensForm lens{r, a};
  const PocketTable table = pockets(SphereSet(cube_corners(a, r)));
  ASSERT_EQ(table.pockets.size(), 1u);
  const Pocket& pocket = table.pockets[0];
  EXPECT_EQ(pocket.kind, PocketKind::channel);
  EXPECT_GT(table.cell_ties, 0u);
  const double volume = a * a * a - 4 * kPi * r * r * r / 3 + 3 * lens.volume();
  const double area = 4 * kPi * r * r - 3 * lens.area();
  EXPECT_NEAR(pocket.volume, volume, kRounding);
  EXPECT_NEAR(pocket.volume_sum, volume, kRounding);
  EXPECT_NEAR(pocket.area, area, kRounding);
  EXPECT_NEAR(pocket.area_sum, area, kRounding);
  EXPECT_NEAR(pocket.depth_alpha, 3 * a * a / 4 - r * r, kRounding);
  EXPECT_NEAR(pocket.bottleneck_alpha, a * a / 2 - r * r, kRounding);
  EXPECT_NEAR(pocket.clearance.value(), std::sqrt(3.0) * a / 2 - r, kRounding);
  EXPECT_NEAR(pocket.bottleneck_clearance.value(), a / std::sqrt(2.0) - r, kRounding);
  ASSERT_EQ(pocket.mouths.size(), 6u);
  for (const Mouth& mouth : pocket.mouths) {
    EXPECT_EQ(mouth.faces, 2u);
    EXPECT_NEAR(mouth.area, a * a - kPi * r * r + 2 * lens.section(), kRounding);
    EXPECT_NEAR(mouth.area_sum, mouth.area, kRounding);
    EXPECT_NEAR(mouth.rim, 2 * kPi * r - 8 * lens.angle() * r, kRounding);
    EXPECT_NEAR(mouth.rim_sum, mouth.rim, kRounding);
    const Vec3d from_middle = mouth.center - Vec3d{a / 2, a / 2, a / 2};
    EXPECT_NEAR(norm(from_middle), a / 2, kRounding);
  }
  ASSERT_EQ(pocket.lining.size(), 8u);
  for (const LiningSphere& s : pocket.lining) EXPECT_NEAR(s.area, area / 8, kRounding);
}

// The edges are 2 × scale long.
std::vector<Sphere> icosahedron(double edge, double radius) {
  const double s = edge / 2, g = s * std::numbers::phi;
  std::vector<Sphere> balls;
  for (const double u : {-s, s}) {
    for (const double v : {-g, g}) {
      balls.push_back({{0, u, v}, radius});
      balls.push_back({{u, v, 0}, radius});
      balls.push_back({{v, 0, u}, radius});
    }
  }
  return balls;
}

TEST(PocketClosedForms, IcosahedronHasAMouthInEachFace) {
  constexpr double s = 5.1, r = 2.9;
  const LensForm lens{r, s};
  const Pocket pocket = pockets(SphereSet(icosahedron(s, r))).pockets.at(0);
  const double dihedral = std::acos(-std::sqrt(5.0) / 3), solid = 5 * dihedral - 3 * kPi;
  const double whole = 5 * (3 + std::sqrt(5.0)) * s * s * s / 12;
  EXPECT_NEAR(pocket.volume,
              whole - 4 * solid * r * r * r + 30 * dihedral / (2 * kPi) * lens.volume(), kRounding);
  EXPECT_NEAR(pocket.area, 12 * solid * r * r - 30 * dihedral / (2 * kPi) * lens.area(), kRounding);
  EXPECT_NEAR(pocket.bottleneck_alpha, s * s / 3 - r * r, kRounding);
  EXPECT_EQ(pocket.spheres, 12u);
  ASSERT_EQ(pocket.mouths.size(), 20u);
  for (const Mouth& mouth : pocket.mouths) {
    EXPECT_NEAR(mouth.area, std::sqrt(3.0) / 4 * s * s - kPi * r * r / 2 + 1.5 * lens.section(),
                kRounding);
    EXPECT_NEAR(mouth.rim, kPi * r - 6 * lens.angle() * r, kRounding);
  }
}

TEST(PocketClosedForms, IcosahedronClosesAndOpensByAFace) {
  constexpr double s = 4.8, r = 2.9, smaller = 2.73;  // the face's gate is s / √3 = 2.771
  std::vector<Sphere> balls = icosahedron(s, r);
  const Pocket closed = pockets(SphereSet(balls)).pockets.at(0);
  EXPECT_EQ(closed.kind, PocketKind::enclosed);
  EXPECT_NEAR(closed.bottleneck_alpha, s * s / 3 - r * r, kRounding);
  EXPECT_NEAR(closed.bottleneck_clearance.value(), s / std::sqrt(3.0) - r, kRounding);
  // The face in the octant x, y, z > 0.
  for (Sphere& b : balls) {
    if (b.center.x >= 0 && b.center.y >= 0 && b.center.z >= 0) b.radius = smaller;
  }
  const Pocket open = pockets(SphereSet(balls)).pockets.at(0);
  EXPECT_EQ(open.kind, PocketKind::pocket);
  EXPECT_EQ(open.mouths.at(0).faces, 1u);
  EXPECT_NEAR(open.bottleneck_alpha, s * s / 3 - smaller * smaller, kRounding);
  EXPECT_NEAR(open.bottleneck_clearance.value(), s / std::sqrt(3.0) - smaller, kRounding);
}

// Sets without room: too few balls, and balls in a plane or on a line.
TEST(PocketClosedForms, FlatSetsHaveNone) {
  EXPECT_TRUE(pockets(SphereSet({{{0, 0, 0}, 1}})).pockets.empty());
  std::vector<Sphere> plane, line;
  for (int i = 0; i < 5; ++i) {
    line.push_back({{2.0 * i, 0, 0}, 1});
    for (int j = 0; j < 5; ++j) plane.push_back({{2.5 * i, 2.5 * j, 0}, 1.3});
  }
  EXPECT_TRUE(pockets(SphereSet(line)).pockets.empty());
  EXPECT_TRUE(pockets(SphereSet(plane)).pockets.empty());
  EXPECT_THROW(pockets(SphereSet()), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
