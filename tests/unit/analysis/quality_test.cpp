#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/mesh_measures.hpp"
#include "analysis/survey/quality_parts.hpp"
#include "core/errors.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

constexpr double kRounding = 1e-13;  // relative, of a few operations in double

TEST(Quality, OfEquilateralTriangles) {
  const MeshQuality found = quality(testing::icosahedron());
  EXPECT_NEAR(found.min_angle_deg.min, 60, 60 * kRounding);
  EXPECT_NEAR(found.min_angle_deg.max, 60, 60 * kRounding);
  EXPECT_NEAR(found.aspect_ratio.max, 1, kRounding);
  EXPECT_NEAR(found.edge_length.min, 2, 2 * kRounding);
  EXPECT_NEAR(found.edge_length.mean, 2, 2 * kRounding);
  EXPECT_EQ(found.degenerate_triangles, 0u);
}

TEST(Quality, OfACube) {
  const MeshQuality found = quality(testing::cube());
  // Right isosceles: 45°, R / 2r = (sqrt(2)/2) / (2 - sqrt(2)); 12 edges of 1, 6 diagonals.
  const double r2 = std::numbers::sqrt2;
  EXPECT_NEAR(found.min_angle_deg.median, 45, 45 * kRounding);
  EXPECT_NEAR(found.aspect_ratio.median, r2 / 2 / (2 - r2), 2 * kRounding);
  EXPECT_NEAR(found.edge_length.mean, (12 + 6 * r2) / 18, 2 * kRounding);
  EXPECT_NEAR(found.edge_length.median, 1, kRounding);
  EXPECT_NEAR(found.edge_length.max, r2, 2 * kRounding);
}

TEST(Quality, OfNeedles) {
  // The angle at the origin is atan(h) whichever way the triangle's vertices are named.
  const double h = 1e-9;
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{1, 2, 0}, Triangle{2, 0, 1}}) {
    const IndexedMesh mesh = testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {1, h, 0}}, {t});
    const double expected = std::atan(h) * 180 / std::numbers::pi;
    EXPECT_NEAR(quality(mesh).min_angle_deg.min, expected, expected * 1e-12);
  }
}

TEST(Quality, CountsDegenerateTriangles) {
  const IndexedMesh mesh = testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                                              {{0, 1, 2}, {0, 1, 1}, {0, 1, 3}});
  const MeshQuality found = quality(mesh);
  EXPECT_EQ(found.degenerate_triangles, 2u);
  EXPECT_EQ(found.min_angle_deg.min, 0);
  EXPECT_TRUE(std::isfinite(found.aspect_ratio.max));
  EXPECT_NEAR(found.min_angle_deg.max, 45, 45 * kRounding);
}

TEST(MinAngles, AreThoseOfEachTriangleInOrder) {
  IndexedMesh mesh = testing::tetrahedron();  // three right isosceles faces, one equilateral
  mesh.triangles.push_back({0, 1, 1});
  const std::vector<float> angles = min_angles_deg(mesh);
  constexpr float kFloatRounding = 60 * 0x1p-23f;  // degrees
  ASSERT_EQ(angles.size(), 5u);
  for (std::size_t t = 0; t < 3; ++t) EXPECT_NEAR(angles[t], 45, kFloatRounding) << t;
  EXPECT_NEAR(angles[3], 60, kFloatRounding);
  EXPECT_EQ(angles[4], 0);
  mesh.triangles[1][2] = 4;
  EXPECT_THROW(min_angles_deg(mesh), InvalidInput);
}

// Right-angled triangles that share nothing, with the legs 1 and legs[t]: the smallest angle of
// each is the arc tangent of the second leg.
IndexedMesh right_angled(const std::vector<double>& legs) {
  IndexedMesh mesh;
  for (std::uint32_t t = 0; t < legs.size(); ++t) {
    for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, legs[t], 0}})
      mesh.positions.push_back(p);
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return mesh;
}

void expect_ranks(const Distribution& found, std::vector<double> values, double rounding) {
  std::sort(values.begin(), values.end());
  const auto of_rank = [&](std::size_t hundredths) {
    return values[(values.size() * hundredths + 99) / 100 - 1];
  };
  EXPECT_NEAR(found.min, values.front(), rounding);
  EXPECT_NEAR(found.p01, of_rank(1), rounding);
  EXPECT_NEAR(found.median, of_rank(50), rounding);
  EXPECT_NEAR(found.p99, of_rank(99), rounding);
  EXPECT_NEAR(found.max, values.back(), rounding);
}

void expect_quality_of_a_sort(const std::vector<double>& legs) {
  std::vector<double> angles, lengths;
  for (const double h : legs) {
    angles.push_back(std::atan(h) * 180 / std::numbers::pi);
    lengths.insert(lengths.end(), {1, h, std::hypot(1, h)});
  }
  const IndexedMesh mesh = right_angled(legs);
  for (const MeshQuality& found : {quality(mesh), examine(mesh).quality}) {
    expect_ranks(found.min_angle_deg, angles, 90 * kRounding);
    expect_ranks(found.edge_length, lengths, 2 * kRounding);
  }
}

TEST(Quality, PercentilesAreThoseOfASort) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> leg(0.01, 1);
  // As many triangles as keep all values, and as many as are looked at by a sample first.
  for (const std::size_t triangles : {1003u, 70'001u, 140'000u}) {
    SCOPED_TRACE(triangles);
    std::vector<double> legs(triangles);
    for (double& h : legs) h = leg(random);
    expect_quality_of_a_sort(legs);
    // The triangles of the sample are unlike the others, so it expects the percentiles elsewhere.
    for (std::size_t t = 0; t < triangles; t += usual_sample_step(triangles)) legs[t] = 0.001;
    expect_quality_of_a_sort(legs);
  }
}

TEST(Quality, OfNothingIsNotANumber) {
  const MeshQuality found = quality(testing::empty_mesh());
  EXPECT_TRUE(std::isnan(found.min_angle_deg.median));
  EXPECT_TRUE(std::isnan(found.edge_length.mean));
}

}  // namespace
}  // namespace vdwmesh
