#include "extract/grid.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "core/errors.hpp"
#include "extract/field.hpp"

namespace vdwmesh {
namespace {

SphereSet box_of_two() { return SphereSet({{{0, 0, 0}, 1.0}, {{10, 4, 2}, 1.5}}); }

TEST(Grid, CoversTheBallsAndThePadding) {
  GridOptions options;
  options.spacing = 0.3;
  options.padding = 0.7;
  const GridSpec grid = make_grid(box_of_two(), options);
  EXPECT_DOUBLE_EQ(grid.origin.x, -1.7);
  EXPECT_GE(grid.origin.x + 0.3 * static_cast<double>(grid.cells.x), 11.5 + 0.7);
  EXPECT_LT(grid.origin.x + 0.3 * static_cast<double>(grid.cells.x - 1), 11.5 + 0.7);
}

// The recovered grid of the thesis: floor((extent + 2 padding) / h) cells around the centres.
TEST(Grid, OfTheThesisEndsInsideThePaddedBoxOfTheCentres) {
  const GridOptions options = preset_grid(FieldPreset::thesis, {}, {});
  const GridSpec grid = make_grid(box_of_two(), options);
  EXPECT_DOUBLE_EQ(grid.origin.x, -5.0);
  EXPECT_EQ(grid.cells.x, 50);  // 20 / 0.4
  EXPECT_EQ(grid.cells.y, 35);
  EXPECT_EQ(grid.cells.z, 30);
}

TEST(Grid, RefusesOptionsWithoutMeaning) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GridOptions options;
  EXPECT_THROW(make_grid(SphereSet(), options), InvalidInput);
  for (const double spacing : {0.0, -0.5, nan, std::numeric_limits<double>::infinity()}) {
    options.spacing = spacing;
    EXPECT_THROW(make_grid(box_of_two(), options), InvalidInput) << spacing;
  }
  options.spacing = 0.5;
  options.padding = -1;
  EXPECT_THROW(make_grid(box_of_two(), options), InvalidInput);
}

// Doubles are 2 apart at 1e16, and 2^-10 at 8e12: 512 places on an edge of 0.5.
TEST(Grid, RefusesSpacingsThatDoublesDoNotResolve) {
  GridOptions options;
  options.spacing = 0.5;
  for (const double far : {1e16, -1e16}) {
    EXPECT_THROW(make_grid(SphereSet({{{0, far, 0}, 2}}), options), LimitExceeded);
    GridOptions given;
    given.given = GridSpec{{0, 0, far}, 0.5, {9, 9, 9}};
    EXPECT_THROW(make_grid(SphereSet({{{0, 0, far}, 2}}), given), LimitExceeded);
  }
  EXPECT_NO_THROW(make_grid(SphereSet({{{0, 8e12, 0}, 2}}), options));
  EXPECT_THROW(make_grid(SphereSet({{{0, 8e13, 0}, 2}}), options), LimitExceeded);
}

TEST(Grid, RefusesMoreCellsThanKeysCanNumber) {
  GridOptions options;
  options.spacing = 1e-9;
  EXPECT_THROW(make_grid(box_of_two(), options), LimitExceeded);
}

TEST(Bricks, KeysOrderZYXAndComeBack) {
  const BrickIndex a{5, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  EXPECT_LT(brick_key(a), brick_key(b));
  EXPECT_LT(brick_key(b), brick_key(c));
  const BrickIndex far{131071, 70000, 131072};
  EXPECT_EQ(brick_of_key(brick_key(far)), far);
}

TEST(FieldOptions, RefuseParametersOfOtherFields) {
  GridOptions options;
  const GridSpec grid = make_grid(box_of_two(), options);
  FieldOptions field;
  field.isovalue = 1;
  EXPECT_THROW(make_field_model(field, grid), InvalidInput);  // vdw has no isovalue
  field = {};
  field.preset = FieldPreset::thesis;
  EXPECT_THROW(make_field_model(field, grid), InvalidInput);
  field = {};
  field.kind = FieldKind::blinn;
  field.isovalue = -1;
  EXPECT_THROW(make_field_model(field, grid), InvalidInput);
  field.isovalue = 1;
  field.blobbiness = 1000;
  EXPECT_THROW(make_field_model(field, grid), InvalidInput);
}

// Blinn's largest value at an atom is e^B / 0.84^2; float32 holds 2^-126 of 1, and the search keeps
// some room from that.
TEST(FieldOptions, RefuseIsovaluesThatFloat32DoesNotHold) {
  const GridSpec grid = make_grid(box_of_two(), {});
  FieldOptions field;
  for (const FieldKind kind :
       {FieldKind::blinn, FieldKind::soft_object, FieldKind::inverse_squared}) {
    field.kind = kind;
    for (const double refused : {1e-46, 1e-32, 1e39}) {
      field.isovalue = refused;
      EXPECT_THROW(make_field_model(field, grid), InvalidInput) << refused;
    }
    for (const double taken : {1e-28, 1.0, 1e38}) {
      field.isovalue = taken;
      EXPECT_EQ(make_field_model(field, grid).isovalue, taken);
    }
  }
  field.kind = FieldKind::blinn;
  field.blobbiness = 50;
  field.isovalue = 1e-9;
  EXPECT_THROW(make_field_model(field, grid), InvalidInput);
  field.isovalue = 1e-8;
  EXPECT_EQ(make_field_model(field, grid).steepness, 50);
}

}  // namespace
}  // namespace vdwmesh
