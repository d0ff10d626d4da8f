// Newton projection of single points: onto spheres, circles and corners, and onto a field.
#include "refine/projection_formulas.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "extract/field.hpp"
#include "extract/field_list.hpp"

namespace vdwmesh {
namespace {

constexpr double kReach = 1;  // Å

class Union {
 public:
  explicit Union(std::vector<Sphere> spheres)
      : spheres_(std::move(spheres)), list_(make_ball_list(spheres_)) {}
  ProjectedPoint project(const Vec3d& p, double reach = kReach) const {
    return project_to_union(list_.view(), p, reach);
  }

 private:
  SphereSet spheres_;
  CellList list_;
};

void expect_label(const ProjectedPoint& p, SphereId a, SphereId b, SphereId c) {
  ASSERT_EQ(p.outcome, ProjectionOutcome::converged);
  EXPECT_LE(p.residual, kProjectionTolerance);
  EXPECT_EQ(p.spheres[0], a);
  EXPECT_EQ(p.spheres[1], b);
  EXPECT_EQ(p.spheres[2], c);
}

TEST(ProjectToUnion, OntoOneSphereInOneStep) {
  const Union one({{{0, 0, 0}, 1.5}});
  const ProjectedPoint p = one.project({0, 0.6, 0.8});
  expect_label(p, 0, kNoSphere, kNoSphere);
  EXPECT_EQ(p.steps, 1);
  EXPECT_LE(norm(p.position - Vec3d{0, 0.9, 1.2}), 1e-15);
}

TEST(ProjectToUnion, LeavesAPointOfTheBoundaryAlone) {
  const Union one({{{0, 0, 0}, 1.25}});
  const Vec3d start{0.75, 1, 5e-10};
  const ProjectedPoint p = one.project(start);
  expect_label(p, 0, kNoSphere, kNoSphere);
  EXPECT_EQ(p.steps, 0);
  EXPECT_EQ(p.position, start);
}

TEST(ProjectToUnion, FollowsToTheNextSphereWhereTheFirstIsBuried) {
  const Union two({{{0, 0, 0}, 1}, {{0.4, 0, 0}, 1}});
  // Nearer to the first by a hair; its sphere is buried there.
  const ProjectedPoint p = two.project({0.19, 0.9, 0});
  ASSERT_EQ(p.outcome, ProjectionOutcome::converged);
  EXPECT_LE(p.residual, kProjectionTolerance);
}

TEST(ProjectToUnion, AlternationBetweenTwoEndsOnTheirCircle) {
  // Barely overlapping: at the crease the normals are more than 90 degrees apart.
  const Union two({{{0.95, 0, 0}, 1}, {{-0.95, 0, 0}, 1}});
  const ProjectedPoint p = two.project({0, 0.2, 0.1});
  expect_label(p, 1, 0, kNoSphere);  // canonical order: by x
  const double radius = std::sqrt(1 - 0.95 * 0.95), scale = radius / std::sqrt(0.05);
  EXPECT_LE(norm(p.position - Vec3d{0, 0.2 * scale, 0.1 * scale}), 1e-12);
}

TEST(ProjectToUnion, AlternationAmongThreeEndsOnTheirCorner) {
  // Centres on an equilateral triangle of circumradius 0.97: the corners are at z = ±0.243.
  const double side = 0.97 * std::sqrt(3.0) / 2;
  const Union three({{{0.97, 0, 0}, 1}, {{-0.485, side, 0}, 1}, {{-0.485, -side, 0}, 1}});
  const ProjectedPoint p = three.project({0.003, 0.002, 0.15});
  ASSERT_EQ(p.outcome, ProjectionOutcome::converged);
  expect_label(p, 2, 1, 0);  // canonical order: x, then y
  EXPECT_LE(norm(p.position - Vec3d{0, 0, std::sqrt(1 - 0.97 * 0.97)}), 1e-12);
}

TEST(ProjectToUnion, EquidistantPointsGoToTheLowestRank) {
  const Union two({{{1, 0, 0}, 1.2}, {{-1, 0, 0}, 1.2}});
  const ProjectedPoint p = two.project({0, 1.5, 0});
  expect_label(p, 1, kNoSphere, kNoSphere);
}

TEST(ProjectToUnion, StaysWhereItWasBeyondItsReach) {
  const Union one({{{0, 0, 0}, 1.5}});
  for (const double x : {0.4, 2.6, 50.0}) {
    const ProjectedPoint p = one.project({x, 0, 0});
    EXPECT_EQ(p.outcome, ProjectionOutcome::out_of_reach) << x;
    EXPECT_EQ(p.position, (Vec3d{x, 0, 0}));
    EXPECT_EQ(p.spheres[0], kNoSphere);
  }
}

// The ends of an edge lie on the surface, so its midpoint is at most half its length away from it.
TEST(ProjectToUnion, AMidpointReachesHalfItsEdge) {
  EXPECT_DOUBLE_EQ(midpoint_reach({1, 2, 3}, {1, -1, 7}), 2.5);
  const Union one({{{0, 0, 0}, 1.5}});
  const Vec3d a{2.4, 0.5, 0}, b{2.4, -0.5, 0};  // the midpoint is 0.9 from the sphere
  EXPECT_EQ(one.project({2.4, 0, 0}, midpoint_reach(a, b)).outcome,
            ProjectionOutcome::out_of_reach);
  const Vec3d c{2.4, 1, 0}, d{2.4, -1, 0};
  EXPECT_EQ(one.project({2.4, 0, 0}, midpoint_reach(c, d)).outcome, ProjectionOutcome::converged);
}

TEST(ProjectToUnion, StaysAtACentre) {
  const Union one({{{0, 0, 0}, 0.5}});
  const ProjectedPoint p = one.project({0, 0, 0});
  EXPECT_EQ(p.outcome, ProjectionOutcome::unconverged);
  EXPECT_EQ(p.position, (Vec3d{0, 0, 0}));
}

TEST(ProjectToField, IsSafeguardedFarFromTheSurface) {
  // Inverse squared, R = 1: at d = 0.2 the field is steep, Newton alone needs many small steps.
  const SphereSet spheres({{{0, 0, 0}, 1}});
  FieldOptions options;
  options.kind = FieldKind::inverse_squared;
  const FieldModel model = make_field_model(options, {{0, 0, 0}, 0.5, {1, 1, 1}});
  const CellList list = make_field_list(spheres, model);
  for (const double x : {0.3, 0.7, 0.999, 1.001, 1.5, 1.9}) {
    const ProjectedPoint p = project_to_field(list.view(), model, {x, 0, 0}, 1);
    ASSERT_EQ(p.outcome, ProjectionOutcome::converged) << x;
    EXPECT_NEAR(p.position.x, 1, 2e-9);
    EXPECT_EQ(p.spheres[0], 0u);
  }
  EXPECT_EQ(project_to_field(list.view(), model, {9, 0, 0}, 1).outcome,
            ProjectionOutcome::out_of_reach);
}

TEST(ProjectToField, NeverLeavesItsReach) {
  const SphereSet spheres({{{0, 0, 0}, 1}});
  FieldOptions options;
  options.kind = FieldKind::blinn;
  const FieldModel model = make_field_model(options, {{0, 0, 0}, 0.5, {1, 1, 1}});
  const CellList list = make_field_list(spheres, model);
  const Vec3d start{1.5, 0, 0};  // 0.5 Å from the surface
  const ProjectedPoint p = project_to_field(list.view(), model, start, 0.4);
  EXPECT_NE(p.outcome, ProjectionOutcome::converged);
  EXPECT_EQ(p.position, start);
}

}  // namespace
}  // namespace vdwmesh
