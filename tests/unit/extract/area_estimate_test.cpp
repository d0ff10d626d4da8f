#include "extract/area_estimate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace vdwmesh {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTenPercent = 0.1;  // what the header promises small sets

double estimate(std::vector<Sphere> spheres) {
  return estimate_area(SphereSet(std::move(spheres)));
}

double estimate(std::vector<Sphere> spheres, const FieldOptions& field) {
  GridSpec grid{};
  grid.spacing = 0.5;
  return estimate_area(SphereSet(std::move(spheres)), make_field_model(field, grid));
}

void expect_near(double value, double expected) {
  EXPECT_LE(std::abs(value - expected), kTenPercent * expected) << value << " for " << expected;
}

TEST(AreaEstimate, SpheresThatTouchNothingKeepTheirArea) {
  EXPECT_DOUBLE_EQ(estimate({{{1, 2, 3}, 2}}), 16 * kPi);
  EXPECT_DOUBLE_EQ(estimate({{{0, 0, 0}, 1}, {{9, 0, 0}, 2}}), 20 * kPi);
  EXPECT_EQ(estimate_area(SphereSet()), 0);
}

TEST(AreaEstimate, CapsAreTakenOff) {
  // Two unit spheres at a distance of 1: each loses a cap of height 1/2.
  expect_near(estimate({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}), 2 * (4 * kPi - kPi));
}

TEST(AreaEstimate, BuriedAndRepeatedSpheresCountOnce) {
  EXPECT_DOUBLE_EQ(estimate({{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}}), 16 * kPi);
  EXPECT_DOUBLE_EQ(estimate({{{0, 0, 0}, 2}, {{0, 0, 0}, 2}, {{0, 0, 0}, 2}}), 16 * kPi);
}

TEST(AreaEstimate, ASampleStandsForAllOfManySpheres) {
  std::vector<Sphere> lattice;
  for (int x = 0; x < 30; ++x)
    for (int y = 0; y < 30; ++y)
      for (int z = 0; z < 30; ++z) lattice.push_back({{4.0 * x, 4.0 * y, 4.0 * z}, 1.5});
  const double each = 4 * kPi * 1.5 * 1.5;
  EXPECT_NEAR(estimate(lattice), 27000 * each, 1e-6 * 27000 * each);
}

// The isosurface of an isolated atom is its sphere.
TEST(AreaEstimate, FieldsOfIsolatedSpheresHaveTheirArea) {
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    const FieldOptions field{kind, FieldPreset::radius_aware, {}, {}};
    expect_near(estimate({{{0, 0, 0}, 1.5}, {{20, 0, 0}, 2}}, field), 4 * kPi * (2.25 + 4));
    EXPECT_EQ(estimate({}, field), 0);
  }
}

// A ball whose field nowhere reaches the isovalue has no surface: exp(2) / (1 - 0.16)² is 10.5.
TEST(AreaEstimate, FieldsBelowTheIsovalueHaveNoSurface) {
  const FieldOptions above{FieldKind::blinn, FieldPreset::radius_aware, 20.0, {}};
  EXPECT_EQ(estimate({{{0, 0, 0}, 1.5}}, above), 0);
}

// exp(2 (1 - q)) w(q) = T with w = ((1 - q / 6.25) / (1 - 1 / 6.25))²: roots by bisection.
TEST(AreaEstimate, TheIsovalueMovesTheSurface) {
  const FieldOptions low{FieldKind::blinn, FieldPreset::radius_aware, 0.9, {}},
      high{FieldKind::blinn, FieldPreset::radius_aware, 1.5, {}};
  expect_near(estimate({{{0, 0, 0}, 1.5}}, low), 4 * kPi * 2.25 * 1.04422);
  expect_near(estimate({{{0, 0, 0}, 1.5}}, high), 4 * kPi * 2.25 * 0.82927);
}

// Two atoms in one place: 2 w(q) / q = 1 with the same w.
TEST(AreaEstimate, FieldsAddUp) {
  const FieldOptions field{FieldKind::inverse_squared, FieldPreset::radius_aware, {}, {}};
  expect_near(estimate({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}}, field), 4 * kPi * 1.58149);
}

}  // namespace
}  // namespace vdwmesh
