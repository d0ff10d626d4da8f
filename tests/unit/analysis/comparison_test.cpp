// A mesh's figures beside the exact ones: by hand.
#include "analysis/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace vdwmesh {
namespace {

MeshTopology closed_mesh(std::int64_t euler_characteristic) {
  MeshTopology topology{};
  topology.closed = topology.manifold = topology.oriented = true;
  topology.euler_characteristic = euler_characteristic;
  return topology;
}

ExactUnion exact(std::int64_t euler_characteristic, std::uint64_t point_contacts) {
  ExactUnion result;
  result.area = 8;
  result.volume = 5;
  result.topology.emplace();
  result.topology->euler_characteristic = euler_characteristic;
  result.topology->point_contacts = point_contacts;
  return result;
}

TEST(Compare, ErrorsAreRelativeToTheExactFigures) {
  const Comparison c = compare(closed_mesh(2), {7, 6, {}, {}}, exact(2, 0));
  EXPECT_DOUBLE_EQ(c.area_relative_error, -1.0 / 8);
  EXPECT_DOUBLE_EQ(c.volume_relative_error.value(), 1.0 / 5);
  EXPECT_EQ(c.euler_characteristic_difference, 0);
  EXPECT_FALSE(c.distances);
}

// A mesh of all spheres cannot be compared with the measures of some; the topology is of all.
TEST(Compare, OfSomeSpheresOnlyTheTopology) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  ExactUnion some = exact(2, 0);
  some.per_sphere = {{8, 5}, {kNaN, kNaN}};
  const Comparison c = compare(closed_mesh(2), {7, 6, {}, {}}, some);
  EXPECT_TRUE(std::isnan(c.area_relative_error));
  EXPECT_FALSE(c.volume_relative_error);
  EXPECT_EQ(c.euler_characteristic_difference, 0);
}

// The errors are 1/8, 1/4 and 1/4; the sphere of 0.5 Å² and the one that was not measured are left
// out, though they are farther off.
TEST(AreaErrors, OfTheMeasuredSpheresThatShowEnough) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::vector<SphereMeasures> exact{{0.5, 1}, {8, 1}, {4, 1}, {kNaN, kNaN}, {16, 1}};
  const std::vector<double> mesh{5, 7, 5, 3, 12};
  const auto errors = area_errors(mesh, exact);
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->spheres, 3u);
  EXPECT_DOUBLE_EQ(errors->max, 0.25);
  EXPECT_DOUBLE_EQ(errors->rms, std::sqrt((1.0 / 64 + 1.0 / 16 + 1.0 / 16) / 3));
  EXPECT_EQ(errors->worst, 2u);
  EXPECT_FALSE(area_errors(mesh, exact, 17));
  EXPECT_FALSE(area_errors({}, exact));
  EXPECT_DOUBLE_EQ(area_errors(mesh, exact, 0.5)->max, 9);
}

// An open mesh has no volume; nor has one whose triangles do not face one way, though its χ counts.
TEST(Compare, WhatTheMeshDoesNotHaveIsLeftEmpty) {
  MeshTopology open = closed_mesh(1);
  open.closed = false;
  const Comparison c = compare(open, {7, {}, {}, {}}, exact(2, 0));
  EXPECT_DOUBLE_EQ(c.area_relative_error, -1.0 / 8);
  EXPECT_FALSE(c.volume_relative_error);
  EXPECT_FALSE(c.euler_characteristic_difference);
  MeshTopology crowded = closed_mesh(2);
  crowded.manifold = false;
  EXPECT_FALSE(compare(crowded, {7, 6, {}, {}}, exact(2, 0)).euler_characteristic_difference);
  ExactUnion unknown = exact(2, 0);
  unknown.topology.reset();
  EXPECT_FALSE(compare(closed_mesh(2), {7, 6, {}, {}}, unknown).euler_characteristic_difference);
}

// Two balls that touch in a point: a 2-manifold has the point twice, so its χ is larger by 2 than
// that of the union's boundary, however many shells say so.
TEST(Compare, PointContactsAreDoubled) {
  EXPECT_EQ(compare(closed_mesh(4), {8, 5, {}, {}}, exact(2, 1)).euler_characteristic_difference,
            0);
  EXPECT_EQ(compare(closed_mesh(2), {8, 5, {}, {}}, exact(2, 1)).euler_characteristic_difference,
            -2);
  EXPECT_EQ(compare(closed_mesh(0), {8, 5, {}, {}}, exact(-6, 3)).euler_characteristic_difference,
            0);
  EXPECT_EQ(compare(closed_mesh(-8), {8, 5, {}, {}}, exact(2, 0)).euler_characteristic_difference,
            -10);
}

// The same from spheres: two that touch, meshed as two.
TEST(Compare, OfBallsThatTouch) {
  const ExactUnion touching = exact_union(SphereSet({{{-1, 0, 0}, 1}, {{1, 0, 0}, 1}}));
  ASSERT_TRUE(touching.topology);
  EXPECT_EQ(compare(closed_mesh(4), {8, 5, {}, {}}, touching).euler_characteristic_difference, 0);
}

}  // namespace
}  // namespace vdwmesh
