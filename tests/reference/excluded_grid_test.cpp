// The oracles of the solvent-excluded surface against each other: counting, which knows the
// definition alone, and quadrature over pieces of the grown solid.
#include "reference/excluded_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "reference/cages.hpp"
#include "reference/excluded_forms.hpp"
#include "support/dice.hpp"

namespace vdwmesh::reference {
namespace {

// Standard errors. A hundred estimates of a normal distribution stay within with probability
// 0.9999; the seed is fixed.
constexpr double kErrors = 5;

void expect_estimate(const Estimate& found, double expected) {
  EXPECT_TRUE(std::abs(found.value - expected) <= kErrors * found.standard_error())
      << found.value << " ± " << found.standard_error() << ", expected " << expected;
}

std::vector<Ball> equal_balls(const std::vector<Point>& centers, double radius) {
  std::vector<Ball> balls;
  for (const Point& c : centers) balls.push_back({c, radius});
  return balls;
}

// The area of a small set to 1 %, its volume to 1e-3, in a tenth of a second.
void expect_form(const std::vector<Ball>& atoms, double probe, const ExcludedForm& expected) {
  const double cell = 0.06 * std::cbrt(expected.volume);
  const ExcludedEstimates found = excluded_grid(atoms, probe, {.line_cell = cell, .halvings = 1});
  EXPECT_LE(found.area.standard_error(), 0.01 * expected.area());
  EXPECT_LE(found.volume.standard_error(), 1e-3 * expected.volume);
  expect_estimate(found.volume, expected.volume);
  expect_estimate(found.area, expected.area());
  expect_estimate(found.contact, expected.contact);
  expect_estimate(found.saddle, expected.saddle);
  expect_estimate(found.concave, expected.concave);
}

TEST(ExcludedGrid, ABallIsItself) {
  ExcludedForm ball;
  add_cone(4 * std::numbers::pi, 2, ball);
  expect_form({{{{1, 2, 3}}, 2}}, 1.4, ball);
}

TEST(ExcludedGrid, TwoBalls) {
  const Ball a{{{0, 0, 0}}, 1.5};
  for (const double apart : {1.0, 2.5, 5.2, 5.6}) {  // a whole ring twice, a spindle, apart
    SCOPED_TRACE(apart);
    const Ball b{{{apart, 0, 0}}, 1.2};
    expect_form({a, b}, 1.4, excluded_two_balls(a, b, 1.4));
  }
}

TEST(ExcludedGrid, SharesOfTwoBalls) {
  const Ball a{{{0, 0, 0}}, 1.5};
  for (const double apart : {2.5, 5.2}) {
    SCOPED_TRACE(apart);
    const Ball b{{{apart, 0, 0}}, 1.2};
    const ExcludedEstimates found = excluded_grid({a, b}, 1.4, {.line_cell = 0.1, .halvings = 1});
    expect_estimate(found.atom_area[0], share_of_first(a, b, 1.4).area());
    expect_estimate(found.atom_area[1], share_of_first(b, a, 1.4).area());
  }
}

// High probes, low ones, and low ones with spindles around all axes.
TEST(ExcludedGrid, ThreeBalls) {
  struct {
    double size, radius;
  } const cases[] = {{2.4, 1.3}, {4.4, 1.3}, {3.6, 0.75}};
  for (const auto& [size, radius] : cases) {
    SCOPED_TRACE(size);
    const std::array<Ball, 3> atoms{{{{{0, 0, 0}}, radius},
                                     {{{size, 0, 0}}, radius + 0.05},
                                     {{{size * 0.45, size * 0.9, 0}}, radius + 0.1}}};
    expect_form({atoms.begin(), atoms.end()}, 1.4, excluded_three_balls(atoms, 1.4));
  }
}

struct CageCase {
  const char* name;
  std::vector<Point> centers;
  double radius, probe;  // Å
  CageSides sides;       // whether the probe has room inside
};

// Probes that touch three to six atoms, high and low ones, with a cavity and without.
std::vector<CageCase> cage_cases() {
  const std::vector<Point> carbon = fullerene(1.458, 1.401);
  return {{"square", regular_polygon(4, 2.8), 1.5, 1.4, CageSides::outer},
          {"square with a hole", regular_polygon(4, 3.7), 1.5, 1.4, CageSides::outer},
          {"hexagon", regular_polygon(6, 1.4), 1.7, 1.4, CageSides::outer},
          {"four drops", regular_polygon(4, 2.6), 0.45, 1.4, CageSides::outer},
          {"six drops", regular_polygon(6, 1.5), 0.13, 1.4, CageSides::outer},
          {"tetrahedron", tetrahedron(3), 1.5, 1.4, CageSides::outer},
          {"octahedron", octahedron(3), 1.5, 1.4, CageSides::outer},
          {"cube", cube(3), 1.5, 1.4, CageSides::outer},
          {"cube with windows", cube(4), 1.5, 1.4, CageSides::both},
          {"icosahedron", icosahedron(3.2), 1.5, 1.2, CageSides::both},
          {"dodecahedron", dodecahedron(2.4), 1.6, 1.4, CageSides::both},
          {"fullerene", carbon, 1.7, 1.4, CageSides::both},
          {"fullerene, large probe", carbon, 1.7, 3, CageSides::outer}};
}

TEST(ExcludedGrid, Cages) {
  for (const CageCase& c : cage_cases()) {
    SCOPED_TRACE(c.name);
    expect_form(equal_balls(c.centers, c.radius), c.probe,
                excluded_cage(hull_cage(c.centers), c.radius, c.probe, c.sides));
  }
}

// A ball that fills the cavity leaves the outer side alone, on which the probe is no longer cut by
// its mirror image.
TEST(ExcludedGrid, AFilledCage) {
  std::vector<Ball> balls = equal_balls(cube(4), 1.5);
  balls.push_back({{{0, 0, 0}}, 0.6});
  expect_form(balls, 1.4, excluded_cage(hull_cage(cube(4)), 1.5, 1.4, CageSides::outer));
}

std::vector<Ball> random_balls(testing::Dice& dice, int count) {
  std::vector<Ball> balls;
  const auto place = [&] { return dice.real(0, 2.2 * std::cbrt(count)); };
  for (int k = 0; k < count; ++k) {
    const double x = place(), y = place(), z = place();
    balls.push_back({{{x, y, z}}, dice.real(1, 2)});
  }
  return balls;
}

// Balls, spheres and arcs that are left out as too far away change nothing.
TEST(AccessibleDistance, NarrowedCandidatesFindTheSame) {
  testing::Dice dice(7);
  for (int set = 0; set < 30; ++set) {
    const std::vector<Ball> balls = random_balls(dice, 2 + set);
    const AccessibleDistance distance(balls, 1.4);
    AccessibleDistance::Candidates kept;
    for (int k = 0; k < 100; ++k) {
      const double half = dice.real(0, 1), reach = half * std::numbers::sqrt3;
      Point middle = balls[static_cast<std::size_t>(dice.whole(0, set + 1))].center;
      for (double& x : middle.at) x += dice.real(-2, 2);
      distance.narrow(distance.all(), middle, reach, kept);
      for (double& x : middle.at) x += dice.real(-half, half);
      EXPECT_EQ(distance.nearest(middle).distance, distance.nearest(middle, kept).distance);
    }
  }
}

// A place that the distance calls the nearest is accessible, and none of many accessible places is
// nearer.
TEST(AccessibleDistance, NoRandomAccessiblePlaceIsNearer) {
  testing::Dice dice(8);
  const std::vector<Ball> balls = random_balls(dice, 12);
  const AccessibleDistance distance(balls, 1.4);
  const auto depth = [&](const Point& p) {  // Å; below 0 outside the grown balls
    double deepest = -1e9;
    for (const Ball& b : balls) {
      deepest = std::max(deepest, b.radius + 1.4 - reference::distance(p, b.center));
    }
    return deepest;
  };
  int accessible = 0;
  for (int k = 0; k < 200; ++k) {
    Point inside = balls[static_cast<std::size_t>(dice.whole(0, 11))].center;
    for (double& x : inside.at) x += dice.real(-1.5, 1.5);
    const NearestAccess found = distance.nearest(inside);
    EXPECT_NEAR(depth(found.point), 0, 1e-9);
    EXPECT_NEAR(reference::distance(inside, found.point), found.distance, 1e-9);
    for (int other = 0; other < 100; ++other) {
      Point place = found.point;
      for (double& x : place.at) x += dice.real(-0.5, 0.5);
      if (depth(place) > 0) continue;
      ++accessible;
      EXPECT_GE(reference::distance(inside, place), found.distance - 1e-9);
    }
  }
  EXPECT_GE(accessible, 1000);
}

}  // namespace
}  // namespace vdwmesh::reference
