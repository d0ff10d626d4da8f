// Derivatives of area and volume against central differences with 60 digits.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "measures/union_gradients.hpp"
#include "reference/union_oracle.hpp"

namespace vdwmesh {
namespace {

// Centre and radius of a ball, as the oracle has them.
using Cluster = std::vector<std::array<double, 4>>;

Cluster drawn_cluster(std::mt19937_64& random) {
  std::uniform_real_distribution<double> place(-1.5, 1.5), radius(0.8, 2);
  Cluster cluster(5);
  for (auto& ball : cluster) ball = {place(random), place(random), place(random), radius(random)};
  return cluster;
}

reference::WideMeasures true_measures(const Cluster& cluster) {
  std::vector<reference::Ball> balls;
  for (const auto& [x, y, z, r] : cluster) balls.push_back({{{x, y, z}}, r});
  return reference::union_oracle(balls);
}

// Of area and volume, by number k of ball i.
std::array<double, 2> differences(const Cluster& cluster, std::size_t i, std::size_t k) {
  constexpr double kStep = 0x1p-30;  // Å; what is left out is of its square
  Cluster up = cluster, down = cluster;
  up[i][k] += kStep;
  down[i][k] -= kStep;
  const reference::Digits width = up[i][k] - down[i][k];  // exact
  const reference::WideMeasures above = true_measures(up), below = true_measures(down);
  return {static_cast<double>(reference::Digits((above.area - below.area) / width)),
          static_cast<double>(reference::Digits((above.volume - below.volume) / width))};
}

// They agree to 2e-14 of 1 + the derivative.
TEST(GradientDifferences, SixtyDigits) {
  constexpr int kClusters = 40;        // 200 balls
  constexpr double kRelative = 1e-10;  // of 1 + the derivative, as of the references
  std::mt19937_64 random(55);
  for (int c = 0; c < kClusters; ++c) {
    const Cluster cluster = drawn_cluster(random);
    std::vector<Sphere> balls;
    for (const auto& [x, y, z, r] : cluster) balls.push_back({{x, y, z}, r});
    const UnionGradients found = union_gradients(SphereSet(balls));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const BallGradient& g = found.gradients[i];
      const std::array<double, 4> area{g.area_center.x, g.area_center.y, g.area_center.z,
                                       g.area_radius},
          volume{g.volume_center.x, g.volume_center.y, g.volume_center.z, g.volume_radius};
      for (std::size_t k = 0; k < 4; ++k) {
        const auto [by_area, by_volume] = differences(cluster, i, k);
        EXPECT_NEAR(area[k], by_area, kRelative * (1 + std::abs(by_area))) << c << ' ' << i;
        EXPECT_NEAR(volume[k], by_volume, kRelative * (1 + std::abs(by_volume))) << c << ' ' << i;
      }
    }
  }
}

}  // namespace
}  // namespace vdwmesh
