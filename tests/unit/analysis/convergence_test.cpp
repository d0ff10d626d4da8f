// Fits and extrapolation of exact power laws.
#include "analysis/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// A logarithm of magnitude 10 is off by 1e-15; a fit over a factor of ten in size divides by 2.
constexpr double kFitTolerance = 1e-13;

template <class F>
std::vector<double> of(const std::vector<double>& sizes, F&& f) {
  std::vector<double> values;
  for (const double h : sizes) values.push_back(f(h));
  return values;
}

TEST(PowerLaw, ExactPowersAreFoundWithoutResidual) {
  const std::vector<double> sizes = {1, 0.7, 0.5, 0.35, 0.125};
  for (const double order : {-0.5, 0.25, 1.0, 2.0, 4.0}) {
    const auto fit = fit_power_law(sizes, of(sizes, [&](double h) {
                                     return -3 * std::pow(h, order);  // sign does not count
                                   }));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->order, order, kFitTolerance);
    EXPECT_NEAR(fit->scale, 3, 3 * kFitTolerance);
    EXPECT_NEAR(fit->rms_residual, 0, kFitTolerance);
    EXPECT_EQ(fit->points, sizes.size());
  }
}

TEST(PowerLaw, ScatterIsTheLeastSquaresOne) {
  // ln h = -1, 0, 1 and ln e = 0, 0, 3: slope (1·0 + 1·3)/2 = 3/2, mean 1, residuals 1/2, -1, 1/2.
  const double e = std::numbers::e;
  const auto fit = fit_power_law(std::vector{1 / e, 1.0, e}, std::vector{1.0, 1.0, e * e * e});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->order, 1.5, kFitTolerance);
  EXPECT_NEAR(fit->scale, e, e * kFitTolerance);
  EXPECT_NEAR(fit->rms_residual, std::sqrt(0.5), kFitTolerance);
}

TEST(PowerLaw, LeavesOutWhatHasNoLogarithm) {
  const auto fit =
      fit_power_law(std::vector{0.25, 0.5, 1.0, 2.0}, std::vector{0.0, 0.5, 1.0, kNaN});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->order, 1, kFitTolerance);
  EXPECT_EQ(fit->points, 2u);
}

TEST(PowerLaw, NeedsTwoSizes) {
  EXPECT_FALSE(fit_power_law({}, {}));
  EXPECT_FALSE(fit_power_law(std::vector{1.0}, std::vector{1.0}));
  EXPECT_FALSE(fit_power_law(std::vector{0.3, 0.3, 0.3}, std::vector{1.0, 2.0, 4.0}));
  EXPECT_FALSE(fit_power_law(std::vector{1.0, 0.5}, std::vector{1.0, 0.0}));
}

TEST(PowerLaw, RefusesWhatIsNoSize) {
  EXPECT_THROW(fit_power_law(std::vector{0.0, 1.0}, std::vector{1.0, 1.0}), InvalidInput);
  EXPECT_THROW(fit_power_law(std::vector{kNaN, 1.0}, std::vector{1.0, 1.0}), InvalidInput);
  EXPECT_THROW(fit_power_law(std::vector{1.0}, std::vector{1.0, 1.0}), InvalidInput);
}

TEST(Extrapolation, FindsLimitAndOrderOfExactPowers) {
  // Differences of values near 100 are good to 1e-14 · 100 / smallest difference of 1e-3.
  constexpr double kTolerance = 1e-8;
  for (const std::vector<double>& sizes :
       {std::vector{1.0, 0.5, 0.25}, std::vector{0.2, 1.0, 0.45}}) {
    for (const double order : {0.5, 1.0, 2.0, 3.5}) {
      for (const double scale : {7.0, -7.0}) {
        const auto found = extrapolate(
            sizes, of(sizes, [&](double h) { return 100 + scale * std::pow(h, order); }));
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->order, order, kTolerance);
        EXPECT_NEAR(found->limit, 100, kTolerance);
      }
    }
  }
}

TEST(Extrapolation, TakesTheThreeSmallestSizes) {
  const std::vector<double> sizes = {4, 0.5, 1, 2};
  const auto found = extrapolate(sizes, std::vector{-1000.0, 1.25, 2.0, 5.0});  // 1 + h²
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->limit, 1, 1e-12);
  EXPECT_NEAR(found->order, 2, 1e-12);
}

TEST(Extrapolation, NothingWhereTheValuesDoNotSettle) {
  const std::vector<double> sizes = {0.25, 0.5, 1};
  EXPECT_FALSE(extrapolate(sizes, std::vector{1.0, 2.0, 1.0}));   // back and forth
  EXPECT_FALSE(extrapolate(sizes, std::vector{1.0, 2.0, 2.9}));   // faster at the fine end
  EXPECT_FALSE(extrapolate(sizes, std::vector{1.0, 2.0, 3.0}));   // order 0: a logarithm
  EXPECT_FALSE(extrapolate(sizes, std::vector{1.0, 1.0, 1.0}));   // any order
  EXPECT_FALSE(extrapolate(sizes, std::vector{1.0, kNaN, 3.0}));  // two values
  EXPECT_FALSE(extrapolate(std::vector{1.0, 1.0, 0.5}, std::vector{1.0, 2.0, 3.0}));
}

}  // namespace
}  // namespace vdwmesh
