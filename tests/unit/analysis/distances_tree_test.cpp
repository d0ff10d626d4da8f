// The pieces distances are made of, each against a plain search that shares no code with it.
#include "analysis/distances/distances_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "analysis/distances.hpp"
#include "analysis/distances/box_tree_lanes.hpp"
#include "analysis/distances/distances_statistics.hpp"
#include "analysis/distances/distances_triangle.hpp"
#include "analysis/distances/sphere_lattice.hpp"
#include "analysis/distances/triangle_points.hpp"
#include "analysis/survey/mesh_area.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using Uniform = std::uniform_real_distribution<double>;

Vec3d random_point(std::mt19937_64& random, double size) {
  Uniform place(-size, size);
  const double x = place(random), y = place(random), z = place(random);
  return {x, y, z};
}

double plain_distance(const Vec3d& a, const Vec3d& b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) +
                   (a.z - b.z) * (a.z - b.z));
}

TEST(BoxTree, FindsTheNearestOfAnyNumberOfPoints) {
  std::mt19937_64 random(1);
  for (const std::uint32_t count : {1u, 3u, 4u, 5u, 31u, 32u, 33u, 257u, 3000u}) {
    std::vector<Vec3d> points(count);
    for (Vec3d& p : points) p = random_point(random, 10);
    if (count > 2) points[1] = points[0];
    const auto box_of_point = [&](std::uint32_t i) { return Box{points[i], points[i]}; };
    const BoxTree tree(count, {{-20, -20, -20}, {20, 20, 20}}, box_of_point);
    for (int trial = 0; trial < 200; ++trial) {
      const Vec3d p = trial < 10 ? points[0] : random_point(random, 20);
      double expected = std::numeric_limits<double>::infinity();
      for (const Vec3d& q : points) expected = std::min(expected, plain_distance(p, q));
      double squared = std::numeric_limits<double>::infinity();
      visit_nearest(tree.view(), tree.view().query(p), squared, [&](std::uint32_t i, double& best) {
        const double d = plain_distance(p, points[i]);
        best = std::min(best, d * d);
      });
      EXPECT_NEAR(std::sqrt(squared), expected, 1e-13 * 40) << count;  // Å, a rounding or two
    }
  }
}

// A node never says that a box is farther than it is, from points and from boxes, and says it well:
// off by at most a step of 1/255 of the extent, doubled because steps are powers of two, on either
// side of three axes. An empty lane is never visited, so its number does not matter.
TEST(BoxNode, DistancesAreLowerBoundsAndNearlyRight) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    const double size = std::pow(10, -std::uniform_real_distribution<double>(0.3, 5)(random));
    const int count = 1 + trial % 8;
    const Vec3d middle = random_point(random, 1 - 2 * size);
    std::array<Box, 8> boxes;
    for (int i = 0; i < count; ++i) {
      const Vec3d a = middle + random_point(random, size), b = middle + random_point(random, size);
      Box& box = boxes[static_cast<std::size_t>(i)];
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = std::min(a[axis], b[axis]);
        box.upper[axis] = std::max(a[axis], b[axis]);
      }
    }
    const BoxNode node = make_box_node(boxes.data(), count);
    const Vec3d a = random_point(random, 1);
    const Vec3d b = trial % 3 == 0 ? a : a + 0.01 * Vec3d{1, 2, 3};
    BoxQuery query{};
    for (int axis = 0; axis < 3; ++axis) {
      query.lower[axis] = static_cast<float>(a[axis]);
      query.upper[axis] = static_cast<float>(b[axis]);
    }
    float found[8];
    squared_distances(node, query, found);
    for (int i = 0; i < count; ++i) {
      const Box& box = boxes[static_cast<std::size_t>(i)];
      double exact = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double off = std::max({box.lower[axis] - b[axis], a[axis] - box.upper[axis], 0.0});
        exact += off * off;
      }
      const double distance = std::sqrt(static_cast<double>(found[i]));
      EXPECT_LE(distance, std::sqrt(exact) * (1 + 1e-6));
      EXPECT_GE(distance, std::sqrt(exact) - std::sqrt(3.0) * (2 * 2 * size / 255 + 1e-6));
    }
    for (const float bound : {0.0f, found[0], 1.5f * found[count / 2], 100.0f}) {
      const NearLanes one_by_one(node, query, bound);
      const NearEight together(node, query, bound);
      EXPECT_EQ(together.near, one_by_one.near);
      for (int i = 0; i < count; ++i) EXPECT_EQ(together.distance[i], one_by_one.distance[i]);
    }
    const Box all = box_of(node);
    for (int i = 0; i < count; ++i)
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(all.lower[axis], boxes[static_cast<std::size_t>(i)].lower[axis]);
        EXPECT_GE(all.upper[axis], boxes[static_cast<std::size_t>(i)].upper[axis]);
      }
  }
}

TEST(BoxTree, BoxesThatAreAllAlikeOrFarAway) {
  const Box here{{5, 5, 5}, {5, 5, 5}};
  const BoxTree same(100, here, [&](std::uint32_t) { return here; });
  int visits = 0;
  double squared = 1;
  visit_nearest(same.view(), same.view().query({5, 5, 5}), squared,
                [&](std::uint32_t, double&) { ++visits; });
  EXPECT_EQ(visits, 100);
  const BoxTree far(100, {{0, 0, 0}, {1e6, 1, 1}}, [](std::uint32_t i) {
    return Box{{1e6 - i, 0, 0}, {1e6 - i, 1, 1}};
  });
  squared = std::numeric_limits<double>::infinity();
  visit_nearest(
      far.view(), far.view().query({0, 0, 0}), squared,
      [&](std::uint32_t i, double& best) { best = std::min(best, (1e6 - i) * (1e6 - i)); });
  EXPECT_EQ(squared, (1e6 - 99.0) * (1e6 - 99.0));
}

// Nested shrinking grids over (u, v): slow, and knows nothing of regions.
double searched_distance(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  double u0 = 0.5, v0 = 0.5, step = 0.5, best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 120; ++round, step *= 0.8) {
    double nu = u0, nv = v0;
    for (int i = -4; i <= 4; ++i)
      for (int j = -4; j <= 4; ++j) {
        double u = std::clamp(u0 + i * step / 4, 0.0, 1.0);
        double v = std::clamp(v0 + j * step / 4, 0.0, 1.0);
        if (u + v > 1) {
          const double over = (u + v - 1) / 2;
          u = std::max(0.0, u - over);
          v = std::min(1.0 - u, std::max(0.0, v - over));
        }
        const Vec3d q = a + u * (b - a) + v * (c - a);
        const double d = plain_distance(p, q);
        if (d < best) {
          best = d;
          nu = u;
          nv = v;
        }
      }
    u0 = nu;
    v0 = nv;
  }
  return best;
}

TEST(TriangleDistance, AgreesWithASearchInEveryRegion) {
  std::mt19937_64 random(2);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3d a = random_point(random, 1), b = random_point(random, 1),
                c = random_point(random, 1);
    const Vec3d p = random_point(random, trial % 2 ? 1.0 : 4.0);
    // The search ends with steps of 1e-12, but may leave the valley a little early.
    EXPECT_NEAR(std::sqrt(squared_distance_to_triangle(p, a, b, c)), searched_distance(p, a, b, c),
                1e-6);
  }
}

TEST(TriangleDistance, SegmentsAndPoints) {
  const Vec3d o{0, 0, 0}, x{1, 0, 0}, far{3, 0, 0}, p{2, 1, 0};
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle(p, o, o, o), 5);
  for (const auto& [a, b, c] :
       {std::array{o, o, far}, std::array{o, far, o}, std::array{far, o, o}, std::array{o, x, far},
        std::array{x, far, o}, std::array{far, o, x}})
    EXPECT_DOUBLE_EQ(squared_distance_to_triangle(p, a, b, c), 1);
  for (const auto& [a, b, c] : {std::array{o, x, x}, std::array{x, o, x}, std::array{x, x, o}})
    EXPECT_DOUBLE_EQ(squared_distance_to_triangle(p, a, b, c), 2);
  // All but a segment, in a direction where no coordinate is exact.
  const Vec3d d{1 / 3.0, 1 / 7.0, 1 / 11.0};
  const Vec3d beside = 0.4 * d + Vec3d{-1 / 7.0, 1 / 3.0, 0};  // at right angles to d
  EXPECT_NEAR(std::sqrt(squared_distance_to_triangle(beside, o, 0.3 * d, d)),
              std::hypot(1 / 7.0, 1 / 3.0), 1e-7);
}

// The digits of the number one by one, each a step into one of four triangles, as in the paper.
TEST(PointOfTriangle, FollowsTheDigits) {
  std::mt19937_64 random(6);
  for (int trial = 0; trial < 2000; ++trial) {
    const double fraction = trial < 4 ? std::array{0.0, 1.0, 0.25, 0.999}[std::size_t(trial)]
                                      : std::uniform_real_distribution<double>(0, 1)(random);
    const std::array<Vec3d, 3> whole{random_point(random, 3), random_point(random, 3),
                                     random_point(random, 3)};
    std::array<Vec3d, 3> t = whole;
    double rest = fraction;
    for (int i = 0; i < 24; ++i) {
      const int digit = std::min(static_cast<int>(4 * rest), 3);
      rest = 4 * rest - digit;
      const Vec3d ab = 0.5 * (t[0] + t[1]), bc = 0.5 * (t[1] + t[2]), ca = 0.5 * (t[2] + t[0]);
      if (digit == 0) t = {bc, ca, ab};
      if (digit == 1) t = {t[0], ab, ca};
      if (digit == 2) t = {ab, t[1], bc};
      if (digit == 3) t = {ca, bc, t[2]};
    }
    const Vec3d expected = (1.0 / 3) * (t[0] + t[1] + t[2]);
    const Vec3d found = point_of_triangle({whole[0], whole[1], whole[2]}, fraction);
    EXPECT_LE(plain_distance(found, expected), 1e-14) << fraction;  // Å: some roundings of 3 Å
  }
}

// Every point once, for sizes around those where the step of the walk changes; and steps of about
// the mean distance of neighbours, √(4π / size), but for the ends of columns at the poles.
TEST(SphereLattice, TheWalkVisitsAllPointsInShortSteps) {
  for (const std::uint64_t size : {1u, 2u, 3u, 7u, 8u, 50u, 360u, 361u, 1000u, 12345u}) {
    Random random(1, size);
    const SphereLattice lattice(size, random);
    std::vector<int> visits(size);
    std::vector<double> steps;
    Vec3d before{};
    for (std::uint64_t step = 0; step < size; ++step) {
      const std::uint64_t k = lattice.at(step);
      ASSERT_LT(k, size);
      ++visits[k];
      const Vec3d point = lattice.point(static_cast<double>(k));
      EXPECT_NEAR(plain_distance(point, {0, 0, 0}), 1, 1e-14);
      if (step > 0) steps.push_back(plain_distance(before, point));
      before = point;
    }
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(size));
    if (size < 100) continue;
    std::sort(steps.begin(), steps.end());
    const double apart = std::sqrt(4 * std::numbers::pi / static_cast<double>(size));
    EXPECT_LT(steps[steps.size() / 2], 1.6 * apart) << size;
  }
}

TEST(PointOfCircle, IsThatOfTheLibrary) {
  for (int i = 0; i < 100000; ++i) {
    const double turns = i / 1e5;
    const CirclePoint found = point_of_circle(turns);
    EXPECT_NEAR(found.cosine, std::cos(2 * std::numbers::pi * turns), 1e-15) << turns;
    EXPECT_NEAR(found.sine, std::sin(2 * std::numbers::pi * turns), 1e-15) << turns;
  }
}

TEST(DistanceHistogram, PercentilesAreGoodToTheirBin) {
  DistanceHistogram histogram;
  EXPECT_TRUE(std::isnan(histogram.percentile(0.5)));
  for (int i = 1; i <= 1000; ++i) histogram.add(1e-3 * i);
  for (const double fraction : {0.001, 0.5, 0.95, 0.99, 1.0}) {
    // A bin is 1/256 of its power of two; its middle is off by half of that at most.
    EXPECT_NEAR(histogram.percentile(fraction), fraction, fraction / 256);
  }
  DistanceHistogram zeros;
  zeros.add(0);
  zeros.add(1e-300);
  EXPECT_EQ(zeros.percentile(0.5), 0);
}

// Points on the boundary of the union, from a dense sampling that asks every ball.
std::vector<Vec3d> sampled_boundary(const std::vector<Sphere>& balls, int per_ball) {
  std::vector<Vec3d> points;
  for (const Sphere& ball : balls) {
    for (int k = 0; k < per_ball; ++k) {
      const double z = 1 - (2 * k + 1.0) / per_ball;
      const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0));
      const double s = std::sqrt(1 - z * z);
      const Vec3d p{ball.center.x + ball.radius * s * std::cos(angle),
                    ball.center.y + ball.radius * s * std::sin(angle),
                    ball.center.z + ball.radius * z};
      const bool buried = std::any_of(balls.begin(), balls.end(), [&](const Sphere& other) {
        return plain_distance(p, other.center) < other.radius - 1e-9;
      });
      if (!buried) points.push_back(p);
    }
  }
  return points;
}

// Points of [-size, size]³ and of twice that.
void expect_distances_to_sampled_boundary(const std::vector<Sphere>& balls, double size,
                                          std::mt19937_64& random) {
  constexpr int kPerBall = 40000;
  const std::vector<Vec3d> boundary = sampled_boundary(balls, kPerBall);
  IndexedMesh points;
  for (int i = 0; i < 300; ++i)
    points.positions.push_back(random_point(random, i % 3 ? size : 2 * size));
  const std::vector<float> found = vertex_distances(points, SphereSet(balls));
  // The lattice's cells are all but square, so a point of a sphere has a sample nearer than their
  // side, √(area per point); where a border cuts the cells the next exposed one may be some cells
  // away. The largest radius is 1.7.
  const double cover = 4 * 1.7 * std::sqrt(4 * std::numbers::pi / kPerBall);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vec3d& p = points.positions[i];
    double expected = std::numeric_limits<double>::infinity();
    for (const Vec3d& q : boundary) expected = std::min(expected, plain_distance(p, q));
    const double distance = std::abs(static_cast<double>(found[i]));
    // Samples are on the boundary, so none is nearer than the true distance.
    EXPECT_LE(distance, expected + 1e-6) << i;
    // Where the nearest point is inside a patch the sampling is wrong only in second order.
    EXPECT_GE(distance, expected - cover) << i;
    const bool inside = std::any_of(balls.begin(), balls.end(), [&](const Sphere& ball) {
      return plain_distance(p, ball.center) < ball.radius;
    });
    EXPECT_EQ(found[i] < 0, inside) << i;
  }
}

class RandomCluster : public ::testing::TestWithParam<int> {};

TEST_P(RandomCluster, DistancesAgreeWithADenselySampledBoundary) {
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  Uniform radius(0.7, 1.7);
  std::vector<Sphere> balls(25);
  for (Sphere& ball : balls) ball = {random_point(random, 2), radius(random)};
  expect_distances_to_sampled_boundary(balls, 2.5, random);
}

class JitteredLattice : public ::testing::TestWithParam<double> {};

// Spacing √2: four unit spheres meet in the middle of each face of a cell, or nearly so.
TEST_P(JitteredLattice, DistancesAgreeWithADenselySampledBoundary) {
  std::mt19937_64 random(7);
  const double jitter = GetParam(), step = std::numbers::sqrt2;
  std::vector<Sphere> balls;
  for (int i = 0; i < 27; ++i) {
    const Vec3d place{step * (i % 3 - 1), step * (i / 3 % 3 - 1), step * (i / 9 - 1)};
    balls.push_back({place + jitter * random_point(random, 1), 1});
  }
  balls.push_back(balls.front());
  expect_distances_to_sampled_boundary(balls, 1.5, random);
}

INSTANTIATE_TEST_SUITE_P(Jitters, JitteredLattice,
                         ::testing::Values(0, 1e-15, 1e-12, 1e-10, 1e-9, 1e-6));
INSTANTIATE_TEST_SUITE_P(Seeds, RandomCluster, ::testing::Range(1, 5));

// Triangles of sizes that differ by ten orders, some without an area, in six blocks. Positions at
// and beside the beginnings of blocks, where sums over blocks and within them round differently.
TEST(MeshArea, APositionHasOnePointWhereverTheCursorStarts) {
  std::mt19937_64 random(8);
  IndexedMesh mesh;
  for (std::uint32_t t = 0; t < 5 * kTrianglesPerAreaBlock + 100; ++t) {
    const double size = std::pow(10, Uniform(-5, 0)(random));
    const Vec3d at = random_point(random, 10);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + random_point(random, size));
    if (t % 7 == 0) mesh.positions.back() = at, mesh.positions[3 * t] = at;
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::vector<double> sums(6);
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    sums[t / kTrianglesPerAreaBlock] += area_of(corners_of(mesh, t));
  std::vector<double> places;
  for (const double start : area_block_starts(sums)) {
    double below = start, above = start;
    for (int step = 0; step < 200; ++step) {
      places.insert(places.end(), {below, above});
      below = std::max(0.0, std::nextafter(below, -1.0)), above = std::nextafter(above, 1e9);
    }
  }
  std::ranges::sort(places);
  const MeshArea area(mesh);
  MeshArea::Cursor walking(area, 0);
  for (const double place : places) {
    ASSERT_EQ(walking.point_at(place), MeshArea::Cursor(area, place).point_at(place)) << place;
  }
}

}  // namespace
}  // namespace vdwmesh
