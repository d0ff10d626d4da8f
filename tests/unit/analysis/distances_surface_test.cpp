// The exposed surface that distances are taken to, against closed forms and the exact dual complex.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <span>

#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/distances_samples.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "complex/dual_complex.hpp"
#include "core/errors.hpp"
#include "support/ball_families.hpp"
#include "support/shared_files.hpp"
#include "support/test_meshes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh {
namespace {

constexpr double kPi = std::numbers::pi;

SphereSet cluster(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, 5), radius(0.8, 1.7);
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), z = place(random);
    balls.push_back({{x, y, z}, radius(random)});
  }
  return SphereSet(balls);
}

std::size_t corners_of(const ExposedSurface& surface) {
  std::size_t count = 0;
  for (const Patch& patch : surface.patches())
    for (const SphereCorner& corner : std::span(patch.corners, patch.corner_count))
      count += corner.first;
  return count;
}

// Each circle from the first of its spheres.
std::size_t circles_of(const ExposedSurface& surface) {
  std::size_t count = 0;
  for (const Patch& patch : surface.patches())
    for (const Cover& cover : std::span(patch.covers, patch.circles))
      count += patch.place < cover.place;
  return count;
}

void expect_as_in_dual_complex(const SphereSet& spheres) {
  const ExposedSurface surface(spheres);
  const DualComplex complex = dual_complex(triangulate(spheres));
  std::size_t patches = 0, circles = 0, corners = 0;
  for (const std::uint8_t exposed : complex.exposed) patches += exposed;
  for (const DualEdge& edge : complex.edges) circles += edge.exposed;
  for (const DualTriangle& t : complex.triangles) corners += t.exposed[0] + t.exposed[1];
  EXPECT_EQ(surface.patches().size(), patches);
  EXPECT_EQ(circles_of(surface), circles);
  EXPECT_EQ(corners_of(surface), corners);
}

double sampled_area(const ExposedSurface& surface, double density) {
  std::uint64_t count = 0;
  for (const Patch& patch : surface.patches()) {
    Random random(1, to_index(patch.place));
    sample_patch(patch, density, random, [&](const Vec3d&) { ++count; });
  }
  return static_cast<double>(count) / density;
}

// Unit balls whose centres are 1 apart share a circle of radius sqrt(3)/2. Its points are sampled
// once, from the first of its balls, though both of them have it.
TEST(ExposedSurface, ACircleIsSampledOnce) {
  constexpr double kDensity = 100;  // per Å
  const SphereSet spheres({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  const ExposedSurface surface(spheres);
  double count = 0;
  for (const Patch& patch : surface.patches()) {
    Random random(1, to_index(patch.place));
    sample_border(patch, kDensity, random, [&](const Vec3d&) { ++count; });
  }
  EXPECT_EQ(count, std::ceil(std::sqrt(3.0) * std::numbers::pi * kDensity));
}

TEST(ExposedSurface, PatchesCirclesAndCornersAreThoseOfTheDualComplex) {
  for (const std::uint64_t seed : {1, 2, 3}) expect_as_in_dual_complex(cluster(40, seed));
  expect_as_in_dual_complex(cluster(400, 4));
}

TEST(ExposedSurface, MoleculesAsInTheDualComplex) {
  VDWMESH_NEEDS_SHARED("reference/4PTI.xyzr");
  for (const double probe : {0.0, 1.4}) {
    expect_as_in_dual_complex(
        testing::read_xyzr(testing::shared_path("reference/4PTI.xyzr"), probe));
  }
}

TEST(ExposedSurface, SamplesAreUniformInArea) {
  // Two unit balls, centres 1 apart: each loses a cap of height 1/2.
  const ExposedSurface lens(SphereSet({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}));
  // The standard deviation of 12566 independent points, 1/4 of them buried; a lattice does better.
  const double deviation = 4 * kPi * std::sqrt(0.25 * 0.75 / (4 * kPi * 1000));  // Å², of one ball
  EXPECT_NEAR(sampled_area(lens, 1000), 2 * (4 * kPi - kPi), std::sqrt(2.0) * deviation);
  // Spheres smaller than a sample have one now and then.
  std::vector<Sphere> tiny;
  for (int i = 0; i < 100000; ++i) tiny.push_back({{double(i), 0, 0}, 0.01});
  const double area = 1e5 * 4 * kPi * 1e-4;  // 1256.6 expected samples; 5 sigma of a binomial
  EXPECT_NEAR(sampled_area(ExposedSurface(SphereSet(tiny)), 10), area, 5 * std::sqrt(area / 10));
}

TEST(ExposedSurface, SampledAreaOfAMolecule) {
  VDWMESH_NEEDS_SHARED("reference/4PTI.xyzr");
  const ExposedSurface surface(testing::read_xyzr(testing::shared_path("reference/4PTI.xyzr")));
  // The exact area by reference/union_of_balls.csv. 58664 independent samples of some 160,000
  // would be off by 0.33 %; a lattice is better.
  EXPECT_NEAR(sampled_area(surface, 10) / 5866.438, 1, 0.0033);
}

TEST(ExposedSurface, BorderSamplesLieOnTwoSpheres) {
  const SphereSet balls({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0.5, 0.8, 0}, 0.9}});
  const ExposedSurface surface(balls);
  int found = 0;
  for (const Patch& patch : surface.patches()) {
    Random random(1, 0);
    sample_border(patch, 20, random, [&](const Vec3d& p) {
      int on = 0, inside = 0;
      for (const Sphere& s : balls.spheres()) {
        const double gap = norm(p - s.center) - s.radius;
        on += std::abs(gap) < 1e-12;  // Å, some roundings
        inside += gap < -1e-9;
      }
      EXPECT_GE(on, 2);
      EXPECT_EQ(inside, 0);
      ++found;
    });
  }
  EXPECT_GT(found, 100);
}

// Over all turns the mean of a turned vector is 0, and that of the product of two coordinates of
// two turned vectors is a third of the vectors' product where the coordinates are one, else 0
// (Schur).
TEST(RandomRotation, IsUniform) {
  constexpr int kTurns = 40000;
  const std::array<Vec3d, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 9> sum{};
  std::array<double, 81> products{};
  for (int t = 0; t < kTurns; ++t) {
    Random random(11, static_cast<std::uint64_t>(t));
    const RandomRotation turn(random);
    std::array<double, 9> entries;
    for (std::size_t a = 0; a < 3; ++a) {
      const Vec3d image = turn(axes[a]);
      for (int k = 0; k < 3; ++k) entries[3 * a + static_cast<std::size_t>(k)] = image[k];
      EXPECT_NEAR(norm(image), 1, 1e-14);
    }
    for (std::size_t i = 0; i < 9; ++i) {
      sum[i] += entries[i];
      for (std::size_t j = 0; j < 9; ++j) products[9 * i + j] += entries[i] * entries[j];
    }
  }
  const double five_sigma = 5 / std::sqrt(3.0 * kTurns);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_NEAR(sum[i] / kTurns, 0, five_sigma) << i;
    for (std::size_t j = 0; j < 9; ++j) {
      EXPECT_NEAR(products[9 * i + j] / kTurns, i == j ? 1.0 / 3 : 0, five_sigma) << i << " " << j;
    }
  }
}

// A vertex of no triangle is not measured, and the boxes of the search are as fine as without it.
TEST(Distances, LeaveOutIsolatedVertices) {
  const SphereSet ball({{{0, 0, 0}, 1}});
  IndexedMesh mesh = testing::icosphere(6);
  const DistancePlan alone = plan_distances(mesh, ball, {});
  mesh.positions.push_back({1e8, 0, 0});
  const DistancePlan plan = plan_distances(mesh, ball, {});
  EXPECT_EQ(plan.world.upper.x, alone.world.upper.x);
  // A triangle that far leaves the others without boxes of their own.
  const auto far = static_cast<std::uint32_t>(mesh.vertex_count() - 1);
  mesh.triangles.push_back({0, 1, far});
  EXPECT_THROW(plan_distances(mesh, ball, {}), LimitExceeded);
}

// Sums of the blocks of samples are counted before they are allocated.
TEST(Distances, CountTheSumsOfSamples) {
  DistanceOptions options{.samples_per_area = 1e3, .memory_limit = 1'000'000};
  EXPECT_EQ(plan_mesh_samples(1e4, options).samples, 10'000'000u);
  EXPECT_THROW(plan_mesh_samples(1e6, options), LimitExceeded);
}

// Of balls grown by a large probe nearly all overlap, but few of them cover what no other does.
TEST(ExposedSurface, KeepsFewOfManyCovers) {
  testing::Dice dice(49);
  std::vector<Sphere> balls;
  for (int i = 0; i < 400; ++i) balls.push_back({testing::random_point(dice, 10), 50});
  const ExposedSurface surface{SphereSet(balls)};
  std::size_t most = 0;
  for (const Patch& patch : surface.searched()) {
    most = std::max<std::size_t>(most, patch.cover_count);
  }
  EXPECT_LT(most, 100u);
  // The covers that are left cover what all do.
  for (const Patch& patch : surface.patches()) {
    for (int i = 0; i < 50; ++i) {
      Vec3d direction = testing::random_point(dice, 1);
      direction = (1 / norm(direction)) * direction;
      const Vec3d point = patch.ball.center + 50.0 * direction;
      double least = 1;
      for (const Sphere& s : balls) {
        if (!(s.center == patch.ball.center)) least = std::min(least, norm(point - s.center) - 50);
      }
      if (std::abs(least) > 1e-6) {
        EXPECT_EQ(is_exposed(patch, direction), least > 0);
      }
    }
  }
}

}  // namespace
}  // namespace vdwmesh
