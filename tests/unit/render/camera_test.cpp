// The mathematics of framing, without a device.
#include "render/camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "render/surface_source.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using namespace testing;

constexpr double kRounding = 1e-9;  // relative to the picture or to unit vectors

Vec3d turn(const Vec3d& p) {  // about (1, 2, 3) by 40°, by Rodrigues' formula
  const Vec3d k = (1 / std::sqrt(14.0)) * Vec3d{1, 2, 3};
  const double a = 40 * std::numbers::pi / 180;
  return std::cos(a) * p + std::sin(a) * cross(k, p) + (1 - std::cos(a)) * dot(k, p) * k;
}

// A box of 6 x 4 x 2 that is longer on one side, turned and far from the origin.
IndexedMesh turned_box() {
  IndexedMesh mesh = cube();
  for (Vec3d& p : mesh.positions) {
    p = turn({6 * p.x, 4 * p.y, 2 * p.z}) + Vec3d{100, -200, 300};
  }
  return mesh;
}

std::vector<View> some_views() {
  std::vector<View> views;
  for (const ViewFrame frame : {ViewFrame::principal, ViewFrame::coordinates}) {
    for (const Vec3d& d : {Vec3d{0, 0, 1}, Vec3d{1, 0, 0}, Vec3d{-1, 2, 0.5}, Vec3d{3, -1, -2}}) {
      views.push_back({frame, d, {0.1, 1, 0.2}});
    }
  }
  return views;
}

std::vector<IndexedMesh> some_meshes() {
  IndexedMesh far_away = translated(torus(24, 12), {1e4, -2e4, 3e4});
  return {turned_box(), icosphere(3), far_away, disc(7),
          make_mesh({{0, 0, 0}, {9, 1, 0}, {2, 3, 0.1}}, {{0, 1, 2}})};
}

struct Extremes {
  double least_x = 9, most_x = -9, least_y = 9, most_y = -9, least_z = 9, most_z = -9;
};

Extremes extremes(const IndexedMesh& mesh, const Camera& camera) {
  Extremes e;
  for (const Vec3d& p : mesh.positions) {
    const Vec3d q = project(camera, p);
    EXPECT_TRUE(std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z));
    e.least_x = std::min(e.least_x, q.x), e.most_x = std::max(e.most_x, q.x);
    e.least_y = std::min(e.least_y, q.y), e.most_y = std::max(e.most_y, q.y);
    e.least_z = std::min(e.least_z, q.z), e.most_z = std::max(e.most_z, q.z);
  }
  return e;
}

TEST(Camera, EveryVertexIsInThePictureAndTheTighterSideIsFilled) {
  constexpr double kMargin = 0.05, kFilled = 1 - 2 * kMargin;
  for (const IndexedMesh& mesh : some_meshes()) {
    const MeshSource source(mesh, Rgb{1, 1, 1});
    for (const View& view : some_views()) {
      for (const double aspect : {0.4, 1.0, 4.0 / 3, 3.0}) {
        for (const auto kind : {CameraProjection::orthographic, CameraProjection::perspective}) {
          const Extremes e = extremes(mesh, frame_surface(source, view, kind, aspect, kMargin));
          const double filled = std::max({-e.least_x, e.most_x, -e.least_y, e.most_y});
          EXPECT_NEAR(filled, kFilled, kRounding);
          EXPECT_GE(e.least_z, -1);
          EXPECT_LE(e.most_z, 1);
        }
      }
    }
  }
}

TEST(Camera, OrthographicPicturesAreCentred) {
  const IndexedMesh mesh = turned_box();
  const MeshSource source(mesh, Rgb{1, 1, 1});
  for (const View& view : some_views()) {
    const Extremes e =
        extremes(mesh, frame_surface(source, view, CameraProjection::orthographic, 1.5, 0));
    EXPECT_NEAR(e.least_x, -e.most_x, kRounding);
    EXPECT_NEAR(e.least_y, -e.most_y, kRounding);
  }
}

// The tighter pair of sides of a perspective picture touches on both of its sides.
TEST(Camera, PerspectivePicturesTouchBothSides) {
  const IndexedMesh mesh = turned_box();
  const MeshSource source(mesh, Rgb{1, 1, 1});
  for (const View& view : some_views()) {
    const Extremes e =
        extremes(mesh, frame_surface(source, view, CameraProjection::perspective, 1.5, 0));
    const bool across = std::abs(std::max(-e.least_x, e.most_x) - 1) < kRounding;
    EXPECT_NEAR(across ? e.least_x : e.least_y, -1, kRounding);
    EXPECT_NEAR(across ? e.most_x : e.most_y, 1, kRounding);
  }
}

// A pinhole: straight lines from the eye, by similar triangles.
TEST(Camera, PerspectiveIsThatOfAPinhole) {
  const IndexedMesh mesh = turned_box();
  const MeshSource source(mesh, Rgb{1, 1, 1});
  const Camera c = frame_surface(source, {}, CameraProjection::perspective, 2, 0.1);
  const Vec3d eye = c.origin + c.eye.x * c.axes[0] + c.eye.y * c.axes[1] + c.eye.z * c.axes[2];
  const double slope = std::tan(kVerticalFieldOfView / 2 * std::numbers::pi / 180);
  for (const Vec3d& p : mesh.positions) {
    const Vec3d ray = p - eye;
    const double depth = -dot(ray, c.axes[2]);
    const Vec3d q = project(c, p);
    EXPECT_NEAR(q.x, dot(ray, c.axes[0]) / depth / (2 * slope), kRounding);
    EXPECT_NEAR(q.y, dot(ray, c.axes[1]) / depth / slope, kRounding);
  }
}

TEST(Camera, NearerIsSmallerDepth) {
  const IndexedMesh mesh = turned_box();
  const MeshSource source(mesh, Rgb{1, 1, 1});
  for (const auto kind : {CameraProjection::orthographic, CameraProjection::perspective}) {
    const Camera c = frame_surface(source, {}, kind, 1, 0.1);
    EXPECT_LT(project(c, c.origin + c.axes[2]).z, project(c, c.origin - c.axes[2]).z);
  }
}

void expect_parallel(const Vec3d& a, const Vec3d& b) {
  EXPECT_NEAR(std::abs(dot(a, b)), 1, kRounding);
}

TEST(PrincipalAxes, OfATurnedBoxAreItsEdges) {
  const IndexedMesh mesh = turned_box();
  const Axes axes = principal_axes(MeshSource(mesh, Rgb{1, 1, 1}));
  expect_parallel(axes[0], turn({1, 0, 0}));
  expect_parallel(axes[1], turn({0, 1, 0}));
  expect_parallel(axes[2], turn({0, 0, 1}));
  EXPECT_NEAR(dot(cross(axes[0], axes[1]), axes[2]), 1, kRounding);
}

// Mean of (p - middle)² over the surface of a box a x b x c along its edge a: the two faces across
// it lie at a/2, over the other four it is a²/12.
TEST(PrincipalAxes, MomentsOfABox) {
  IndexedMesh mesh = cube();
  for (Vec3d& p : mesh.positions) p = {6 * p.x, 4 * p.y, 2 * p.z};
  const SurfaceExtent::Moments m = MeshSource(mesh, Rgb{1, 1, 1}).moments();
  const auto spread = [](double a, double b, double c) {
    const double across = 2 * b * c, sides = 2 * a * (b + c);
    return (across * a * a / 4 + sides * a * a / 12) / (across + sides);
  };
  EXPECT_NEAR(m.covariance[0], spread(6, 4, 2), kRounding);
  EXPECT_NEAR(m.covariance[3], spread(4, 2, 6), kRounding);
  EXPECT_NEAR(m.covariance[5], spread(2, 6, 4), kRounding);
  for (const std::size_t mixed : {1u, 2u, 4u}) EXPECT_NEAR(m.covariance[mixed], 0, kRounding);
}

// A cone's apex is farther from the middle of its area than its base is.
TEST(PrincipalAxes, PointToTheFartherEnd) {
  IndexedMesh cone = disc(32);
  cone.positions[0] = {0, 0, 5};
  for (const double side : {1.0, -1.0}) {
    IndexedMesh mesh = scaled(cone, side);
    EXPECT_GT(side * principal_axes(MeshSource(mesh, Rgb{1, 1, 1}))[0].z, 0.99);
  }
}

TEST(PrincipalAxes, OfASphereAreTheCoordinates) {
  const IndexedMesh mesh = icosphere(2);
  const Axes axes = principal_axes(MeshSource(mesh, Rgb{1, 1, 1}));
  EXPECT_EQ(axes[0], (Vec3d{1, 0, 0}));
  EXPECT_EQ(axes[2], (Vec3d{0, 0, 1}));
}

TEST(View, DirectionsThatAreNoneAreRefused) {
  const IndexedMesh mesh = cube();
  const MeshSource source(mesh, Rgb{1, 1, 1});
  const double nan = std::nan("");
  for (const View& view : {View{ViewFrame::principal, {0, 0, 0}, {0, 1, 0}},
                           View{ViewFrame::principal, {0, 1, 0}, {0, 2, 0}},
                           View{ViewFrame::coordinates, {nan, 0, 1}, {0, 1, 0}},
                           View{ViewFrame::coordinates, {0, 0, 1}, {0, 0, 0}}}) {
    EXPECT_THROW(view_axes(view, source), InvalidInput);
  }
}

}  // namespace
}  // namespace vdwmesh
