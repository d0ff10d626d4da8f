// The shares of ranks: runs of bricks of equal area, and the spheres near them.
#include "distributed/surface_shares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "arrangement/exact_union.hpp"
#include "extract/area_estimate.hpp"

namespace vdwmesh {
namespace {

FieldModel union_on(const SphereSet& spheres, double spacing) {
  GridOptions options;
  options.spacing = spacing;
  return make_field_model({}, make_grid(spheres, options));
}

SphereSet column_of(std::size_t count) {
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < count; ++i) {
    spheres.push_back({{0, 0, 10.0 * static_cast<double>(i)}, 2});
  }
  return SphereSet(spheres);
}

TEST(CutBricks, RunsHaveEqualAreas) {
  std::vector<BrickArea> areas;
  for (std::uint64_t key = 0; key < 100; ++key) areas.push_back({99 - key, 2.0});
  EXPECT_EQ(cut_bricks(areas, 4), (std::vector<std::uint64_t>{0, 25, 50, 75}));
}

TEST(CutBricks, AHeavyBrickIsARunOfItsOwn) {
  const std::vector<BrickArea> areas{{3, 1}, {5, 100}, {7, 1}};
  EXPECT_EQ(cut_bricks(areas, 2), (std::vector<std::uint64_t>{0, 7}));
}

TEST(CutBricks, WithFewerBricksThanRanksTheLastOnesHaveNone) {
  EXPECT_EQ(cut_bricks({{5, 1}, {9, 1}}, 4),
            (std::vector<std::uint64_t>{0, 9, kNoBrickKey, kNoBrickKey}));
  EXPECT_EQ(cut_bricks({}, 3), (std::vector<std::uint64_t>{0, kNoBrickKey, kNoBrickKey}));
}

// Samples of spheres that do not touch are all exposed, so the estimate is exact but for rounding.
TEST(EstimateBricks, ThePartsTogetherAreTheWholeSurface) {
  const SphereSet spheres = column_of(100);
  const double expected = 100 * 4 * std::numbers::pi * 4;  // Å²
  constexpr double kRounding = 1e-9;                       // of sums of 16,000 terms, relative
  for (const std::size_t parts : {1u, 2u, 7u}) {
    double area = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      for (const BrickArea& a : estimate_bricks(spheres, union_on(spheres, 0.5), part, parts)) {
        area += a.area;
      }
    }
    EXPECT_NEAR(area, expected, kRounding * expected) << parts;
  }
}

// Each part looks only at the spheres near its own; what they cover must not count.
TEST(EstimateBricks, PartsKnowWhatTheOthersCover) {
  std::mt19937 random(5);
  std::vector<Sphere> balls;
  const auto number = [&](double most) { return most * static_cast<double>(random()) / 0x1p32; };
  for (int i = 0; i < 3000; ++i) {
    balls.push_back({{number(40), number(40), number(40)}, 1 + number(1)});
  }
  const SphereSet spheres(balls);
  const double expected = exact_union(spheres).area;
  for (const std::size_t parts : {1u, 3u}) {
    double area = 0;
    for (std::size_t part = 0; part < parts; ++part) {
      for (const SurfaceSample& s : sample_surface(spheres, union_on(spheres, 0.5), part, parts)) {
        area += s.area;
        for (const Sphere& ball : balls) {
          EXPECT_GE(norm(s.point - ball.center), ball.radius * (1 - 1e-9));
        }
      }
    }
    EXPECT_NEAR(area, expected, 0.1 * expected) << parts;  // as sample_surface() promises
  }
}

TEST(EstimateBricks, SharesOfAColumnAreEqual) {
  const SphereSet spheres = column_of(64);
  const FieldModel model = union_on(spheres, 0.5);
  const auto begins = cut_bricks(estimate_bricks(spheres, model, 0, 1), 4);
  for (std::size_t rank = 1; rank < 4; ++rank) {
    const double z = model.grid.origin.z + 8 * 0.5 * brick_of_key(begins[rank]).z;
    constexpr double kTwoSpheres = 20;  // Å: bricks do not end where spheres do
    EXPECT_NEAR(z, 160.0 * static_cast<double>(rank), kTwoSpheres) << rank;
  }
}

TEST(SpheresNear, OnlyThoseNearTheRange) {
  const SphereSet spheres = column_of(50);
  const FieldModel model = union_on(spheres, 0.5);
  const KeyRange range{brick_key({0, 0, 60}), brick_key({0, 0, 61})};
  const ChosenSpheres near = spheres_near(spheres, model, range);
  EXPECT_LE(near.ids.size(), 4u);
  EXPECT_TRUE(std::ranges::is_sorted(near.ids));
  EXPECT_EQ(spheres_near(spheres, model, {}).ids.size(), spheres.size());
}

TEST(SpheresNear, IsNeverEmpty) {
  const SphereSet spheres = column_of(3);
  const FieldModel model = union_on(spheres, 0.5);
  EXPECT_EQ(spheres_near(spheres, model, {kNoBrickKey, kNoBrickKey}).ids.size(), 1u);
}

}  // namespace
}  // namespace vdwmesh
