// The searches and ranges that samples of complementarity stand on, beside plain loops.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "interface/covered_angles.hpp"
#include "interface/point_grid.hpp"

namespace vdwmesh::testing {
namespace {

using Points = std::vector<Vec3d>;

std::optional<std::uint32_t> nearest_of_all(const Points& points, const Vec3d& place, double most) {
  std::optional<std::uint32_t> found;
  double least = most * most;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double squared = squared_norm(points[i] - place);
    if (squared > least || (found && squared == least)) continue;
    least = squared;
    found = i;
  }
  return found;
}

void expect_as_all(const Points& points, double cell, const Points& places) {
  const PointGrid grid(points, cell);
  for (const Vec3d& place : places) {
    for (const double most : {0.3, 1.0, 4.0, 200.0}) {
      EXPECT_EQ(grid.nearest(place, most), nearest_of_all(points, place, most));
      const double squared = most * most;
      std::size_t near = 0, all = 0;
      grid.each_near(place, squared, [&](std::uint32_t i, double found) {
        EXPECT_EQ(found, squared_norm(points[i] - place));
        near += found <= squared;
      });
      for (const Vec3d& point : points) all += squared_norm(point - place) <= squared;
      EXPECT_EQ(near, all);
      EXPECT_EQ(grid.has_within(place, most), std::ranges::any_of(points, [&](const Vec3d& point) {
                  return squared_norm(point - place) < squared;
                }));
    }
  }
}

// Coordinates are multiples of a quarter, so that squares are exact, points and places lie on
// borders of cells, and several points are as near.
Points on_quarters(std::mt19937& dice, std::size_t count, int most) {
  std::uniform_int_distribution<int> any(-most, most);
  Points points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back({0.25 * any(dice), 0.25 * any(dice), 0.25 * any(dice)});
  return points;
}

TEST(PointGrids, FindWhatALoopFinds) {
  std::mt19937 dice(7);
  const Points places = on_quarters(dice, 40, 40);  // many outside of the points
  expect_as_all(on_quarters(dice, 300, 12), 0.5, places);
  expect_as_all(on_quarters(dice, 300, 12), 40, places);  // one cell
  expect_as_all(on_quarters(dice, 1, 12), 0.5, places);
  expect_as_all({}, 0.5, places);
  Points with_outlier = on_quarters(dice, 200, 8);
  with_outlier.push_back({1e6, -3e5, 2e5});  // the cells become wider
  expect_as_all(with_outlier, 0.25, places);
}

TEST(CoveredRanges, AreWhatCapsCover) {
  std::mt19937 dice(11);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> height_of(-0.99, 0.99), least_of(-1.2, 1.2);
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  for (int set = 0; set < 200; ++set) {
    std::vector<std::pair<Vec3d, double>> caps;  // normal, least
    std::vector<TiltedCap> tilted;
    for (int i = 0; i < set % 5; ++i) {
      const Vec3d some{normal(dice), normal(dice), normal(dice)};
      caps.emplace_back((1 / norm(some)) * some, least_of(dice));
      tilted.push_back(tilted_cap(x, y, z, caps.back().first, caps.back().second));
    }
    const double height = height_of(dice), radius = std::sqrt(1 - height * height);
    CoveredAngles covered;
    covered.set(tilted, height, radius);
    double done = 0;
    covered.each_part({0, CoveredAngles::kWhole}, [&](const AngleRange& part, bool is_covered) {
      EXPECT_EQ(part.from, done);
      done = part.to;
      for (const double share : {0.01, 0.5, 0.99}) {
        const double at = part.from + share * (part.to - part.from);
        const Vec3d point{radius * std::cos(at), radius * std::sin(at), height};
        const bool is_in = std::ranges::any_of(
            caps, [&](const auto& cap) { return dot(cap.first, point) > cap.second; });
        EXPECT_EQ(is_in, is_covered);
      }
    });
    EXPECT_EQ(done, CoveredAngles::kWhole);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
