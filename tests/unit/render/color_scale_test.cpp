#include "render/color_scale.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

using ::testing::ElementsAre;

constexpr double kRounding = 1e-12;

std::vector<std::string> labels(double lower, double upper, int most) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks({ColorMap::viridis, lower, upper, ""}, most)) {
    result.push_back(tick.label);
  }
  return result;
}

TEST(Ticks, StandAtRoundValues) {
  EXPECT_THAT(labels(0, 60, 7), ElementsAre("0", "10", "20", "30", "40", "50", "60"));
  EXPECT_THAT(labels(-0.15, 0.15, 7),
              ElementsAre("−0.15", "−0.10", "−0.05", "0.00", "0.05", "0.10", "0.15"));
  EXPECT_THAT(labels(-1, 1, 5), ElementsAre("−1.0", "−0.5", "0.0", "0.5", "1.0"));
  EXPECT_THAT(labels(0.3, 7.1, 5), ElementsAre("2", "4", "6"));
  EXPECT_THAT(labels(0, 2000, 5), ElementsAre("0", "500", "1000", "1500", "2000"));
}

TEST(Ticks, LieInsideEvenlyAndAreAtMostAsMany) {
  for (const double width : {1e-6, 0.0037, 0.9999, 1.0, 17.3, 4.2e5}) {
    for (const double lower : {-width / 2, 0.0, width * 0.77}) {
      for (int most = 7; most <= 11; ++most) {
        const auto marks = ticks({ColorMap::viridis, lower, lower + width, ""}, most);
        EXPECT_GE(marks.size(), 2u);
        EXPECT_LE(marks.size(), static_cast<std::size_t>(most));
        EXPECT_GE(marks.front().value, lower - 1e-9 * width);
        EXPECT_LE(marks.back().value, lower + width + 1e-9 * width);
      }
    }
  }
}

TEST(SymmetricBound, HoldsTheShareAsked) {
  std::vector<float> values;
  for (int i = 1; i <= 1000; ++i) values.push_back(static_cast<float>(i % 2 ? i : -i) / 1000);
  EXPECT_NEAR(symmetric_bound(values, 0.45), 0.5, kRounding);
  EXPECT_NEAR(symmetric_bound(values, 0.5), 0.5, kRounding);
  EXPECT_NEAR(symmetric_bound(values, 0.501), 0.6, kRounding);
  EXPECT_NEAR(symmetric_bound(values, 1), 1, kRounding);
}

TEST(SymmetricBound, OfFewValues) {
  const std::vector<float> one = {-9}, two = {2, -4};
  EXPECT_NEAR(symmetric_bound(one, 0.99), 10, kRounding);
  EXPECT_NEAR(symmetric_bound(two, 0), 2, kRounding);
  EXPECT_NEAR(symmetric_bound(two, 0.51), 4, kRounding);
}

TEST(SymmetricBound, OfZerosIsAboveZero) {
  const std::vector<float> zeros(5, 0.0f);
  EXPECT_GT(symmetric_bound(zeros, 0.99), 0);
}

TEST(SymmetricBound, ValuesThatAreNotFiniteAreLeftOut) {
  const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> some = {nan, 1, infinity, -2, -infinity};
  EXPECT_NEAR(symmetric_bound(some, 1), 2, kRounding);
  const std::vector<float> none = {nan, infinity};
  EXPECT_THROW(symmetric_bound(none, 1), InvalidInput);
}

TEST(Tails, AreFoundAndSaidAtTheEnds) {
  ColorScale scale{ColorMap::cool_warm, -1, 1, ""};
  const std::vector<float> within = {-1, 0, 1}, above = {0, 1.5f}, below = {-2, 1}, both = {2, -2};
  EXPECT_EQ(find_tails(scale, within), Tails::none);
  EXPECT_EQ(find_tails(scale, above), Tails::above);
  EXPECT_EQ(find_tails(scale, below), Tails::below);
  EXPECT_EQ(find_tails(scale, both), Tails::both);
  scale.tails = Tails::above;
  EXPECT_EQ(ticks(scale, 5).front().label, "−1.0");
  EXPECT_EQ(ticks(scale, 5).back().label, "≥ 1.0");
  scale.tails = Tails::both;
  const std::vector<Tick> marks = ticks(scale, 5);
  EXPECT_EQ(marks.front().label, "≤ −1.0");
  EXPECT_EQ(marks[2].label, "0.0");
  EXPECT_EQ(marks.back().label, "≥ 1.0");
}

TEST(ColorScale, BoundsOutOfOrderAreRefused) {
  EXPECT_THROW(check({ColorMap::viridis, 1, 1, ""}), InvalidInput);
  EXPECT_THROW(check({ColorMap::viridis, 0, std::nan(""), ""}), InvalidInput);
  EXPECT_NO_THROW(check({ColorMap::viridis, -1, 1, ""}));
}

}  // namespace
}  // namespace vdwmesh
