// SurfacePatch: normals and curvatures beside the parametric form of sphere and torus.
#include "surface/surface_patch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr double kRounding = 1e-12;

constexpr Vec3d kAxis{1.0 / 3, -2.0 / 3, 2.0 / 3}, kCenter{4, -3, 2};

SurfacePatch ball(PatchKind kind, double radius) {
  SurfacePatch patch;
  patch.kind = kind;
  patch.center = kCenter;
  patch.radius = radius;
  return patch;
}

SurfacePatch saddle(double ring_radius, double probe) {
  SurfacePatch patch = ball(PatchKind::saddle, probe);
  patch.axis = kAxis;
  patch.ring_radius = ring_radius;
  return patch;
}

// The point of a saddle at a turn and a profile angle, and its outward normal: A + (ρ - p cos α) e
// + p sin α u and cos α e - sin α u.
struct TorusFrame {
  Vec3d point, normal;
};
TorusFrame at(const SurfacePatch& patch, double turn, double alpha) {
  const Vec3d first{2.0 / 3, 2.0 / 3, 1.0 / 3}, second = cross(kAxis, first);
  const Vec3d e = std::cos(turn) * first + std::sin(turn) * second;
  const double girth = patch.ring_radius - patch.radius * std::cos(alpha);
  return {patch.center + girth * e + (patch.radius * std::sin(alpha)) * kAxis,
          std::cos(alpha) * e - std::sin(alpha) * kAxis};
}

TEST(SurfacePatch, SpheresCurveAlikeEverywhere) {
  for (const double radius : {0.7, 1.5}) {
    const Vec3d out{0.6, 0, -0.8}, p = kCenter + radius * out;
    const SurfacePatch contact = ball(PatchKind::contact, radius),
                       concave = ball(PatchKind::concave, radius);
    EXPECT_LE(norm(patch_normal(contact, p) - out), kRounding);
    EXPECT_LE(norm(patch_normal(concave, p) + out), kRounding);
    EXPECT_DOUBLE_EQ(patch_curvatures(contact, p).mean(), 1 / radius);
    EXPECT_DOUBLE_EQ(patch_curvatures(concave, p).mean(), -1 / radius);
    EXPECT_DOUBLE_EQ(patch_curvatures(contact, p).gaussian(), 1 / (radius * radius));
    EXPECT_DOUBLE_EQ(patch_curvatures(concave, p).gaussian(), 1 / (radius * radius));
  }
}

// A ring, and a spindle beyond its cusp angle. Curvatures are those of Monge: -1/p along the
// profile and cos α / (ρ - p cos α) around the axis.
TEST(SurfacePatch, SaddlesHaveTheCurvaturesOfATorus) {
  for (const double ring_radius : {2.5, 0.9}) {
    const SurfacePatch patch = saddle(ring_radius, 1.4);
    for (const double alpha : {-1.4, -1.0, 1.1, 1.3}) {
      for (const double turn : {0.0, 1.0, 4.0}) {
        const TorusFrame frame = at(patch, turn, alpha);
        EXPECT_LE(norm(patch_normal(patch, frame.point) - frame.normal), kRounding);
        const PrincipalCurvatures c = patch_curvatures(patch, frame.point);
        EXPECT_DOUBLE_EQ(c.along, -1 / 1.4);
        const double around = std::cos(alpha) / (ring_radius - 1.4 * std::cos(alpha));
        EXPECT_NEAR(c.around, around, kRounding * std::abs(around));
        EXPECT_NEAR(c.mean(), (around - 1 / 1.4) / 2, kRounding);
        EXPECT_NEAR(c.gaussian(), -around / 1.4, kRounding);
      }
    }
  }
}

// The same from the definition: how the normal turns along the surface.
TEST(SurfacePatch, CurvatureIsTheTurnOfTheNormal) {
  constexpr double kStep = 1e-5, kOfSecondOrder = 1e-8;
  const SurfacePatch patch = saddle(2.5, 1.4);
  const auto turn_of_normal = [](const TorusFrame& a, const TorusFrame& b) {
    const Vec3d along = b.point - a.point;
    return dot(b.normal - a.normal, along) / squared_norm(along);
  };
  const double along = turn_of_normal(at(patch, 1, 0.4 - kStep), at(patch, 1, 0.4 + kStep));
  const double around = turn_of_normal(at(patch, 1 - kStep, 0.4), at(patch, 1 + kStep, 0.4));
  const PrincipalCurvatures c = patch_curvatures(patch, at(patch, 1, 0.4).point);
  EXPECT_NEAR(c.along, along, kOfSecondOrder);
  EXPECT_NEAR(c.around, around, kOfSecondOrder);
}

// Two triangles of a contact patch, one of a concave patch and one of a spindle's saddle, whose
// cusp is vertex 4; two of its corners are of the saddle alone, and so is vertex 7, a cusp as well.
TEST(SurfacePatch, VerticesBetweenPatchesHaveTheMean) {
  PatchedMesh mesh;
  SurfacePatch contact = ball(PatchKind::contact, 1.5), concave = ball(PatchKind::concave, 1.4);
  const SurfacePatch spindle = saddle(0.9, 1.4);
  mesh.patches = {contact, concave, spindle};
  mesh.triangle_patch = {0, 0, 1, 2, 2};
  mesh.mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 5, 6}, {6, 5, 7}};
  const double theta = std::acos(0.9 / 1.4);
  const Vec3d somewhere = kCenter + Vec3d{1, 1, 1};
  mesh.mesh.positions.assign(8, somewhere);
  const Vec3d cusp = kCenter + (1.4 * std::sin(theta)) * kAxis;
  mesh.mesh.positions[5] = at(spindle, 0, 1.2).point;
  mesh.mesh.positions[6] = at(spindle, 0.2, 1.2).point;
  // Of a saddle about the axis z, whose points are on it to the last bit.
  SurfacePatch upright = spindle;
  upright.axis = {0, 0, 1};
  mesh.patches[2] = upright;
  const Vec3d tip{kCenter.x, kCenter.y, kCenter.z + norm(cusp - kCenter)};
  mesh.mesh.positions[4] = mesh.mesh.positions[7] = tip;
  const auto girth = [&](std::size_t v) {
    return std::hypot(mesh.mesh.positions[v].x - kCenter.x, mesh.mesh.positions[v].y - kCenter.y);
  };
  const VertexCurvatures c = vertex_curvatures(mesh);
  constexpr double kFloat = 1e-6;  // relative
  EXPECT_NEAR(c.mean[0], 1 / 1.5, kFloat);
  EXPECT_NEAR(c.gaussian[1], 1 / (1.5 * 1.5), kFloat);
  for (const std::size_t between : {2u, 3u}) {
    EXPECT_NEAR(c.mean[between], (1 / 1.5 - 1 / 1.4) / 2, kFloat);
    EXPECT_NEAR(c.gaussian[between], (1 / (1.5 * 1.5) + 1 / (1.4 * 1.4)) / 2, kFloat);
  }
  EXPECT_NEAR(c.mean[4], -1 / 1.4, kFloat);  // the saddle does not count in its cusp
  const double around = (0.9 - girth(5)) / (1.4 * girth(5));
  EXPECT_NEAR(c.gaussian[5], -around / 1.4, kFloat * std::abs(around));
  EXPECT_TRUE(std::isnan(c.mean[7]) && std::isnan(c.gaussian[7]));
  const auto shared = patches_of_shared_vertices(mesh);
  ASSERT_EQ(shared.size(), 6u);
  const std::uint32_t expected[][2] = {{2, 0}, {2, 1}, {3, 0}, {3, 1}, {4, 1}, {4, 2}};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(shared[i].vertex, expected[i][0]);
    EXPECT_EQ(shared[i].patch, expected[i][1]);
  }
}

TEST(SurfacePatch, TrianglesWithoutAPatchAreRefused) {
  PatchedMesh mesh;
  mesh.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.mesh.triangles = {{0, 1, 2}};
  EXPECT_THROW(check_patches(mesh), InvalidInput);
  mesh.triangle_patch = {0};
  EXPECT_THROW(check_patches(mesh), InvalidInput);
  EXPECT_THROW(vertex_curvatures(mesh), InvalidInput);
  mesh.patches.push_back(ball(PatchKind::contact, 1));
  EXPECT_NO_THROW(check_patches(mesh));
  mesh.triangle_patch = {0, 0};
  EXPECT_THROW(check_patches(mesh), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
