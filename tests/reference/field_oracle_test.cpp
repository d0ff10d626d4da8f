// The oracles against what the equations say of them.
#include "reference/field_oracle.hpp"

#include <gtest/gtest.h>

#include <random>
#include <tuple>

#include "reference/closed_forms.hpp"

namespace vdwmesh::reference {
namespace {

using Case = std::tuple<Function, Preset>;

class FieldOracleTest : public ::testing::TestWithParam<Case> {
 protected:
  FieldOracle field() const {
    return {std::get<0>(GetParam()), std::get<1>(GetParam()), {{-9, -9, -9}, 0.4}, 2};
  }
};

TEST_P(FieldOracleTest, GradientIsTheDerivative) {
  const std::vector<Ball> balls{{{0, 0, 0}, 1.7}, {{1.1, 0.3, -0.2}, 1.2}, {{-0.4, 1.3, 0.9}, 1.5}};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.1, 1.1);
  const double step = 1e-5;  // Å; the truncation of a central difference is step² f'''/6 ~ 1e-9
  for (int i = 0; i < 200; ++i) {
    const Point p{place(random), place(random), place(random)};
    double nearest = 9;
    for (const Ball& b : balls) nearest = std::min(nearest, distance(b.center, p));
    if (nearest < 0.2) continue;
    const Point g = sample_field(field(), balls, p).gradient;
    for (std::size_t a = 0; a < 3; ++a) {
      Point up = p, down = p;
      up[a] += step;
      down[a] -= step;
      const double difference =
          (sample_field(field(), balls, up).value - sample_field(field(), balls, down).value) /
          (2 * step);
      ASSERT_NEAR(g[a], difference, 1e-6 * (1 + std::abs(difference)) / (nearest * nearest));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, FieldOracleTest,
                         ::testing::Values(Case{Function::blinn, Preset::radius_aware},
                                           Case{Function::soft_object, Preset::radius_aware},
                                           Case{Function::inverse_squared, Preset::radius_aware},
                                           Case{Function::blinn, Preset::thesis},
                                           Case{Function::soft_object, Preset::thesis},
                                           Case{Function::inverse_squared, Preset::thesis},
                                           Case{Function::inverse_squared, Preset::thesis_vdw}));

TEST(FieldOracle, AnIsolatedAtomsIsosurfaceIsItsSphere) {
  for (const Function f : {Function::blinn, Function::soft_object, Function::inverse_squared}) {
    for (const double r : {1.2, 1.7, 2.3}) {
      const FieldOracle field{f, Preset::radius_aware, {}, 2};
      const std::vector<Ball> balls{{{0.3, -1, 2}, r}};
      const auto inside = [&](const Point& p) { return sample_field(field, balls, p).value >= 1; };
      const Point direction{2. / 3, -1. / 3, 2. / 3};
      const auto d = bisect(inside, balls[0].center, direction, 4);
      ASSERT_TRUE(d);
      EXPECT_NEAR(*d, r, 1e-12);
    }
  }
}

TEST(FieldOracle, WindowsEndSmoothly) {
  for (const Function f : {Function::blinn, Function::soft_object, Function::inverse_squared}) {
    const FieldOracle field{f, Preset::radius_aware, {}, 2};
    const std::vector<Ball> balls{{{0, 0, 0}, 1.6}};
    const double end = f == Function::soft_object ? 3.2 : 4.0;
    const FieldSample s = sample_field(field, balls, {end - 1e-6, 0, 0});
    EXPECT_NEAR(s.value, 0, 1e-11);
    EXPECT_NEAR(length(s.gradient), 0, 1e-5);
    EXPECT_EQ(sample_field(field, balls, {end + 1e-6, 0, 0}).value, 0);
  }
}

TEST(FieldOracle, SubGridIsABoxOfWholeVoxels) {
  const FieldOracle field{Function::inverse_squared, Preset::thesis_vdw, {{0, 0, 0}, 0.5}, 2};
  const std::vector<Ball> balls{{{5.3, 5.3, 5.3}, 1.7}};  // voxel 10: nodes 6 .. 14, 3 Å .. 7 Å
  EXPECT_GT(sample_field(field, balls, {7, 5, 5}).value, 0);
  EXPECT_EQ(sample_field(field, balls, {7.001, 5, 5}).value, 0);
  EXPECT_GT(sample_field(field, balls, {3, 3, 3}).value, 0);
  EXPECT_EQ(sample_field(field, balls, {2.999, 5, 5}).value, 0);
}

TEST(ClosedForms, LensOfEqualBallsThroughEachOthersCentre) {
  // Two unit balls at distance 1 have 5 pi / 12 in common.
  EXPECT_NEAR(lens_volume(1, 1, 1), 1.3089969389957472, 1e-14);
  EXPECT_NEAR(two_balls(1, 1, 1).area, 18.84955592153876, 1e-13);  // 6 pi
  EXPECT_NEAR(two_balls(2, 1, 3).volume, ball(2).volume + ball(1).volume, 1e-13);
  EXPECT_NEAR(two_balls(2, 1, 0.5).volume, ball(2).volume, 1e-13);
}

}  // namespace
}  // namespace vdwmesh::reference
