// Outlines of depth maps that are drawn by hand.
#include "render/outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

namespace vdwmesh {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

DepthMap map_of(int width, int height, float (*distance)(int, int)) {
  DepthMap map{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) map.distances.push_back(distance(x, y));
  }
  return map;
}

TEST(Outline, IsADiscAroundASinglePoint) {
  const DepthMap map = map_of(21, 15, [](int x, int y) { return x == 10 && y == 7 ? 1 : kFar; });
  for (const double radius : {0.5, 1.0, 3.0, 4.5}) {
    const std::vector<std::uint8_t> lines = find_outline(map, 0.1, radius);
    for (int y = 0; y < 15; ++y) {
      for (int x = 0; x < 21; ++x) {
        const bool is_near = std::hypot(x - 10, y - 7) <= radius;
        EXPECT_EQ(lines[static_cast<std::size_t>(21 * y + x)] != 0, is_near) << x << ' ' << y;
      }
    }
  }
}

// The step is at the column 10, whose samples are the last of the nearer side.
TEST(Outline, FollowsAStepThatIsHighEnough) {
  const DepthMap map = map_of(21, 5, [](int x, int) { return x <= 10 ? 5.0f : 6.0f; });
  for (const double jump : {0.9, 1.1}) {
    const std::vector<std::uint8_t> lines = find_outline(map, jump, 2);
    for (int x = 0; x < 21; ++x) {
      EXPECT_EQ(lines[static_cast<std::size_t>(2 * 21 + x)] != 0,
                jump < 1 && std::abs(x - 10) <= 2);
    }
  }
}

// A slope has no end, however far it goes; nor has the border of the picture.
TEST(Outline, LeavesSlopesAndBordersAlone) {
  const DepthMap map =
      map_of(30, 30, [](int x, int y) { return 0.5f * static_cast<float>(x + y); });
  for (const std::uint8_t line : find_outline(map, 0.6, 2)) EXPECT_EQ(line, 0);
}

}  // namespace
}  // namespace vdwmesh
