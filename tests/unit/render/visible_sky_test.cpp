// How much of the sky a point of a mesh sees, where geometry says it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/surface_source.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using namespace testing;

std::vector<float> sky_of(const IndexedMesh& mesh) {
  const Buffer<Vec3f> normals = vertex_normals(mesh);
  return visible_sky(mesh, {normals.data(), normals.size()}, MeshSource(mesh, Rgb{1, 1, 1}));
}

// A disc about the axis z at a height, facing up.
IndexedMesh disc_at(double radius, double height) {
  constexpr int kCorners = 256;
  std::vector<Vec3d> points{{0, 0, height}};
  std::vector<Triangle> triangles;
  for (std::uint32_t k = 0; k < kCorners; ++k) {
    const double angle = 2 * std::numbers::pi * k / kCorners;
    points.push_back({radius * std::cos(angle), radius * std::sin(angle), height});
    triangles.push_back({0, 1 + k, 1 + (k + 1) % kCorners});
  }
  return make_mesh(points, triangles);
}

// A direction stands for the 96th part of a half-space, so it has up to 2/96 of the light. Those
// whose part the rim of a shadow cuts are about as many as the rim is long in widths of such parts:
// up to 2π / sqrt(2π / 96) = 25. Each is counted too much or too little by half at most, and by
// chance: three standard deviations of the sum of 25 uniform errors.
const double kSky = 3 * std::sqrt(25 / 12.0) * 2 / 96;

// The disc that throws the shadow takes R² / (R² + h²) of the light (the form factor of a disc from
// a point below its centre; J. R. Howell, A Catalog of Radiation Heat Transfer Configuration
// Factors, B-12).
TEST(VisibleSky, ADiscTakesItsFormFactor) {
  for (const double height : {0.3, 0.7, 1.0, 1.5, 3.0}) {
    const std::vector<float> sky = sky_of(together(disc_at(0.02, 0), disc_at(1, height)));
    EXPECT_NEAR(sky[0], 1 - 1 / (1 + height * height), kSky) << height;
    EXPECT_NEAR(sky[257], 1, 1e-6) << "the upper side of the disc sees all";
  }
}

TEST(VisibleSky, AConvexBodySeesAllOfIt) {
  EXPECT_GT(std::ranges::min(sky_of(icosphere(4))), 0.999f);
}

TEST(VisibleSky, TheInsideOfAClosedBodySeesNothing) {
  EXPECT_EQ(std::ranges::max(sky_of(reversed(icosphere(4)))), 0);
}

// A ball of radius R takes (R / d)² cos β of the light of a point at distance d from its centre,
// which is seen by the angle β off the normal, if all of the ball is above the horizon; and none if
// all of it is below (Howell's B-47).
TEST(VisibleSky, ABallTakesItsFormFactor) {
  const IndexedMesh ball = icosphere(4);
  const Vec3d other{3, 0, 0};
  const std::vector<float> sky = sky_of(together(ball, translated(ball, other)));
  for (std::size_t v = 0; v < ball.vertex_count(); ++v) {
    const Vec3d p = ball.positions[v], to = other - p;
    const double d = norm(to),
                 above = dot(p, to);  // the ball's radius is 1, and so is its normal's
    if (above > -1 && above < 1) continue;
    EXPECT_NEAR(sky[v], above < 0 ? 1 : 1 - above / (d * d * d), kSky) << p.x;
  }
}

TEST(VisibleSky, AnyNumberOfThreadsFindsTheSame) {
  const IndexedMesh mesh = torus(64, 32);
  const std::vector<float> sky = sky_of(mesh);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(sky_of(mesh), sky);
}

}  // namespace
}  // namespace vdwmesh
