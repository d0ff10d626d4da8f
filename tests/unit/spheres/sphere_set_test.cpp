#include "spheres/sphere_set.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

TEST(SphereSet, RefusesWhatIsNotABall) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SphereSet({{{nan, 0, 0}, 1}}), InvalidInput);
  EXPECT_THROW(SphereSet({{{0, inf, 0}, 1}}), InvalidInput);
  EXPECT_THROW(SphereSet({{{0, 0, 0}, 0}}), InvalidInput);
  // The box of these overflows, and with it the search for cells that fit.
  EXPECT_THROW(SphereSet({{{1e308, 0, 0}, 1}, {{-1e308, 0, 0}, 1}}), InvalidInput);
  EXPECT_THROW(SphereSet({{{0, -1.0000001e30, 0}, 1}}), InvalidInput);
  EXPECT_THROW(SphereSet({{{0, 0, 0}, 1.0000001e30}}), InvalidInput);
  EXPECT_EQ(SphereSet({{{1e30, -1e30, 1e30}, 1e30}}).size(), 1u);
  EXPECT_THROW(SphereSet({{{0, 0, 0}, -1}}), InvalidInput);
  EXPECT_THROW(SphereSet({{{0, 0, 0}, nan}}), InvalidInput);
}

std::vector<Sphere> three() { return {{{0, 0, 0}, 1}, {{1, 2, 3}, 1.5}, {{-4, 5, 6}, 2}}; }

void expect_spheres(const SphereSet& set, const std::vector<Sphere>& expected) {
  ASSERT_EQ(set.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(set[i].center, expected[i].center) << i;
    EXPECT_EQ(set[i].radius, expected[i].radius) << i;
  }
}

TEST(SphereSet, AViewLooksAtTheCallersSpheres) {
  const std::vector<Sphere> spheres = three();
  const SphereSet view = SphereSet::view(spheres);
  expect_spheres(view, spheres);
  EXPECT_EQ(view.spheres().data(), spheres.data());
  const SphereSet copy = view;
  EXPECT_EQ(copy.spheres().data(), spheres.data());
}

TEST(SphereSet, AViewOfRowsHasFourNumbersASphere) {
  const std::vector<double> rows{0, 0, 0, 1, 1, 2, 3, 1.5, -4, 5, 6, 2};
  expect_spheres(SphereSet::view(std::span<const double>(rows)), three());
  EXPECT_THROW(SphereSet::view(std::span<const double>(rows.data(), 11)), InvalidInput);
  EXPECT_TRUE(SphereSet::view(std::span<const double>()).empty());
}

TEST(SphereSet, AViewIsCheckedToo) {
  std::vector<double> rows{0, 0, 0, 1, 1, 2, 3, -1};
  EXPECT_THROW(SphereSet::view(std::span<const double>(rows)), InvalidInput);
  rows[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SphereSet::view(std::span<const double>(rows)), InvalidInput);
}

TEST(SphereSet, CopiesAndMovesKeepTheSpheres) {
  SphereSet set(three());
  const SphereSet copy = set;
  EXPECT_NE(copy.spheres().data(), set.spheres().data());
  expect_spheres(copy, three());
  const Sphere* const where = set.spheres().data();
  const SphereSet moved = std::move(set);
  EXPECT_EQ(moved.spheres().data(), where);
  expect_spheres(moved, three());
  SphereSet assigned;
  assigned = copy;
  expect_spheres(assigned, three());
}

TEST(SphereSet, MovesToNewCentresWithTheSameRadii) {
  const std::vector<Vec3d> centers{{9, 8, 7}, {6, 5, 4}, {3, 2, 1}};
  const std::vector<Sphere> expected{{{9, 8, 7}, 1}, {{6, 5, 4}, 1.5}, {{3, 2, 1}, 2}};
  SphereSet owner(three());
  const Sphere* const where = owner.spheres().data();
  owner.move_to(centers);
  expect_spheres(owner, expected);
  EXPECT_EQ(owner.spheres().data(), where) << "the memory is kept";

  // A view's caller does not see his spheres move.
  const std::vector<Sphere> theirs = three();
  SphereSet view = SphereSet::view(theirs);
  view.move_to(centers);
  expect_spheres(view, expected);
  EXPECT_EQ(theirs[0].center, (Vec3d{0, 0, 0}));
}

TEST(SphereSet, AMoveThatIsRefusedChangesNothing) {
  SphereSet set(three());
  const std::uint64_t revision = set.revision();
  EXPECT_THROW(set.move_to(std::vector<Vec3d>(2)), InvalidInput);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(set.move_to(std::vector<Vec3d>{{1, 1, 1}, {1, 1, 1}, {1, nan, 1}}), InvalidInput);
  expect_spheres(set, three());
  EXPECT_EQ(set.revision(), revision);
}

TEST(SphereSet, GrownBallsKeepTheirCentres) {
  const std::vector<Sphere> larger = {{{0, 0, 0}, 1.25}, {{1, 2, 3}, 1.75}, {{-4, 5, 6}, 2.25}};
  expect_spheres(grown(three(), 0.25), larger);
  EXPECT_THROW(grown(three(), -1), InvalidInput) << "the first ball would have no radius";
}

TEST(SphereSet, BoxesAreThoseOfBallsAndOfCentres) {
  const Box balls = bounding_box(SphereSet(three())),
            centers = center_bounding_box(SphereSet(three()));
  EXPECT_EQ(balls.lower, (Vec3d{-6, -1, -1}));
  EXPECT_EQ(balls.upper, (Vec3d{2.5, 7, 8}));
  EXPECT_EQ(centers.lower, (Vec3d{-4, 0, 0}));
  EXPECT_EQ(centers.upper, (Vec3d{1, 5, 6}));
}

TEST(SphereSet, ARevisionNamesTheContents) {
  SphereSet set(three());
  const SphereSet copy = set, same(three());
  EXPECT_EQ(copy.revision(), set.revision());
  EXPECT_NE(same.revision(), set.revision()) << "equal spheres, but nobody compared them";
  const std::uint64_t before = set.revision();
  set.move_to(std::vector<Vec3d>(3));
  EXPECT_NE(set.revision(), before);
  EXPECT_EQ(copy.revision(), before);
  const std::vector<Sphere> spheres = three();
  EXPECT_NE(SphereSet::view(spheres).revision(), SphereSet::view(spheres).revision());
}

}  // namespace
}  // namespace vdwmesh
