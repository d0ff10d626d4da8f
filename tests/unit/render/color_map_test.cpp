#include "render/color_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

double linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

// CIE L* of an sRGB colour, 0 to 100.
double lightness(const Rgb& c) {
  const double y = 0.2126729 * linear(c.r) + 0.7151522 * linear(c.g) + 0.0721750 * linear(c.b);
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

// Steps of the 256 colours of a legend.
constexpr int kSteps = 255;

TEST(ColorMap, LightnessOfSequentialMapsRises) {
  for (const ColorMap map : {ColorMap::viridis, ColorMap::cividis}) {
    for (int i = 1; i <= kSteps; ++i) {
      const double before = lightness(color_at(map, (i - 1.0) / kSteps));
      EXPECT_GT(lightness(color_at(map, double(i) / kSteps)), before) << i;
    }
  }
}

TEST(ColorMap, LightnessOfViridisRisesEvenly) {
  const double first = lightness(color_at(ColorMap::viridis, 0));
  const double last = lightness(color_at(ColorMap::viridis, 1));
  for (int i = 0; i <= kSteps; ++i) {
    const double t = double(i) / kSteps;
    // Made linear in the lightness of CAM02-UCS, which differs from L* by up to 2 over this range.
    EXPECT_NEAR(lightness(color_at(ColorMap::viridis, t)), first + t * (last - first), 2);
  }
}

// Ends and middle as their authors print them.
TEST(ColorMap, PublishedColours) {
  using Bytes = std::array<std::uint8_t, 3>;
  EXPECT_EQ(to_bytes(color_at(ColorMap::viridis, 0)), (Bytes{68, 1, 84}));
  EXPECT_EQ(to_bytes(color_at(ColorMap::viridis, 1)), (Bytes{253, 231, 37}));
  EXPECT_EQ(to_bytes(color_at(ColorMap::cividis, 0)), (Bytes{0, 34, 78}));
  EXPECT_EQ(to_bytes(color_at(ColorMap::cividis, 1)), (Bytes{254, 232, 56}));
  const std::pair<double, Bytes> moreland[] = {
      {0, {59, 76, 192}}, {0.5, {221, 221, 221}}, {1, {180, 4, 38}}};
  for (const auto& [t, expected] : moreland) {
    const Bytes bytes = to_bytes(color_at(ColorMap::cool_warm, t));
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(bytes[c], expected[c], 1) << t;  // the paper gives its Msh to three digits
    }
  }
}

TEST(ColorMap, MiddleOfTheDivergingMapIsNeutralAndLightest) {
  const Rgb middle = color_at(ColorMap::cool_warm, 0.5);
  const auto [least, most] = std::minmax({middle.r, middle.g, middle.b});
  EXPECT_LE(most - least, 0.5f / 255);
  for (int i = 1; i <= kSteps; ++i) {
    const double u = 0.5 * i / kSteps, before = 0.5 * (i - 1) / kSteps;
    for (const double side : {-1.0, 1.0}) {
      EXPECT_LT(lightness(color_at(ColorMap::cool_warm, 0.5 + side * u)),
                lightness(color_at(ColorMap::cool_warm, 0.5 + side * before)));
    }
  }
}

TEST(ColorMap, SidesOfTheDivergingMapAreEquallyLight) {
  for (int i = 0; i <= kSteps; ++i) {
    const double u = 0.5 * i / kSteps;
    EXPECT_NEAR(lightness(color_at(ColorMap::cool_warm, 0.5 - u)),
                lightness(color_at(ColorMap::cool_warm, 0.5 + u)), 1);  // L*: not to be seen
  }
}

// What someone without green (or red) cones sees, as blue-yellow contrast: linear RGB after
// F. Viénot, H. Brettel and J. D. Mollon, "Digital video colourmaps for checking the legibility of
// displays by dichromats", 1999, where red and green fall together.
double blue_against_yellow(const Rgb& c, double red_weight) {
  return linear(c.b) - (red_weight * linear(c.r) + (1 - red_weight) * linear(c.g));
}

TEST(ColorMap, SidesOfTheDivergingMapDifferForDichromats) {
  for (const double red_weight : {0.293, 0.112}) {  // deuteranopes, protanopes
    for (const double u : {0.125, 0.25, 0.5}) {
      EXPECT_GT(blue_against_yellow(color_at(ColorMap::cool_warm, 0.5 - u), red_weight), 0.05);
      EXPECT_LT(blue_against_yellow(color_at(ColorMap::cool_warm, 0.5 + u), red_weight), 0.0);
    }
  }
}

TEST(ColorMap, OutsideTheRangeTheEndsHold) {
  for (const ColorMap map : {ColorMap::viridis, ColorMap::cividis, ColorMap::cool_warm}) {
    EXPECT_EQ(color_at(map, -3), color_at(map, 0));
    EXPECT_EQ(color_at(map, std::numeric_limits<double>::infinity()), color_at(map, 1));
    EXPECT_THROW(color_at(map, std::nan("")), InvalidInput);
  }
}

}  // namespace
}  // namespace vdwmesh
