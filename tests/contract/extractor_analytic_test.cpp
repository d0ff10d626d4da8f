// Shapes whose area, volume and topology are known in closed form.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "contract/extractor_contract.hpp"
#include "reference/closed_forms.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorAnalytic : public ExtractorContract {};
class ExtractorFieldAnalytic : public ExtractorFieldContract {};

using reference::Measures;

// Errors relative to the exact values, positive where the mesh falls short.
struct Shortfall {
  double area = 0, volume = 0;
};

Shortfall shortfall(const reference::MeshFacts& facts, const Measures& exact) {
  return {1 - facts.area / exact.area, 1 - facts.volume / exact.volume};
}

// A ball at the origin, and a speck inside it that moves the grid: with GridBox::centers the grid's
// origin follows the speck, so that the ball lies differently on each axis.
SphereSet ball_on_shifted_grid(double radius, const Vec3d& shift) {
  return SphereSet({{{0, 0, 0}, radius}, {shift, 1e-3}});
}

// A piecewise linear mesh of a smooth surface falls short by c h²: an error ratio of 4 per halving.
// c depends on how the grid lies; the mean over the placements leaves this much of it.
constexpr double kOrderTwo = 4, kOrderTwoSlack = 0.4;
constexpr int kPlacements = 12;

TEST_P(ExtractorFieldAnalytic, OneSphereConvergesWithOrderTwo) {
  Shortfall last;
  for (const double h : {0.24, 0.12, 0.06}) {
    Shortfall mean;
    ExtractOptions options = at_spacing(h);
    options.grid.box = GridBox::centers;
    options.grid.padding = 3;
    for (int i = 0; i < kPlacements; ++i) {
      const double r = 1.7 + 0.0342 * i;
      const Vec3d shift{-0.053 * i, -0.077 * ((5 * i) % kPlacements),
                        -0.081 * ((7 * i) % kPlacements)};
      const ExtractResult result = extract(ball_on_shifted_grid(r, shift), options);
      if (i == 0) expect_sound(result, "sphere of " + std::to_string(r));
      const reference::MeshFacts facts = facts_of(result);
      EXPECT_EQ(facts.euler_characteristic(), 2);
      const Shortfall s = shortfall(facts, reference::ball(r));
      mean.area += s.area / kPlacements;
      mean.volume += s.volume / kPlacements;
    }
    if (last.area != 0) {
      EXPECT_NEAR(last.area / mean.area, kOrderTwo, kOrderTwoSlack) << "spacing " << h;
      EXPECT_NEAR(last.volume / mean.volume, kOrderTwo, kOrderTwoSlack) << "spacing " << h;
    }
    last = mean;
  }
  // The volume between a sphere and an inscribed mesh of edge length h is at most about
  // area h²/(6 r), or h²/(2 r²) of the volume.
  EXPECT_LT(std::abs(last.volume), 0.06 * 0.06 / (2 * 1.7 * 1.7));
}

// The crease is a circle; marching cubes cuts its edge off, which costs area of order h and volume
// of order h².
TEST_P(ExtractorAnalytic, TwoOverlappingSpheresConverge) {
  const Measures exact = reference::two_balls(1.7, 1.5, 1.9);
  const double crease = 2 * std::numbers::pi * 1.5;  // Å, longer than the circle
  Shortfall last;
  for (const double h : {0.2, 0.1, 0.05}) {
    ExtractOptions options;
    options.grid.spacing = h;
    const ExtractResult result = extract(two_spheres(1.7, 1.5, 1.9), options);
    expect_sound(result, "two spheres");
    const reference::MeshFacts facts = facts_of(result);
    EXPECT_EQ(facts.euler_characteristic(), 2);
    const Shortfall s = shortfall(facts, exact);
    EXPECT_GT(s.area, 0);
    // The cut runs inside the cells that the crease crosses: at most a strip of one cell diagonal.
    EXPECT_LT(s.area * exact.area, crease * h * std::sqrt(3.0));
    if (last.area != 0) {
      EXPECT_GT(last.area / s.area, 1.6) << h;
      EXPECT_GT(std::abs(last.volume / s.volume), 2.8) << h;
    }
    last = s;
  }
  EXPECT_LT(std::abs(last.volume), 1e-3);
}

TEST_P(ExtractorFieldAnalytic, RingOfTwelveHasOneHandle) {
  const ExtractResult result = extract(ring_of_spheres(12, 4, 1.6), at_spacing(0.2));
  expect_sound(result, "ring");
  const reference::MeshFacts facts = facts_of(result);
  EXPECT_EQ(facts.euler_characteristic(), 0);
  EXPECT_EQ(facts.positive_shells, 1u);
  EXPECT_EQ(facts.negative_shells, 0u);
  EXPECT_EQ(facts.genus(), 1);
  if (kind() != FieldKind::vdw) return;
  // Smooth part h²/(2 r²) = 0.8 %, and creases cut off on both sides of it.
  EXPECT_NEAR(facts.volume / reference::ring_of_balls(12, 4, 1.6).volume, 1, 0.01);
}

// Along every ray from the centre the union of the shell's balls is one stretch; its ends are those
// of the balls that the ray meets. Volume by the mean over directions.
double shell_volume(const SphereSet& shell, double* void_volume) {
  double outer = 0, inner = 0;
  const int directions = 20000;
  const SphereSet rays = hollow_shell(directions, 1, 1);
  for (const Sphere& ray : rays.spheres()) {
    double far = 0, near = 1e9;
    for (const Sphere& s : shell.spheres()) {
      const double along = dot(ray.center, s.center);
      const double square = s.radius * s.radius - squared_norm(s.center) + along * along;
      if (square < 0 || along < 0) continue;
      far = std::max(far, along + std::sqrt(square));
      near = std::min(near, along - std::sqrt(square));
    }
    outer += far * far * far;
    inner += near * near * near;
  }
  const double scale = 4 * std::numbers::pi / 3 / directions;
  *void_volume = inner * scale;
  return (outer - inner) * scale;
}

TEST_P(ExtractorFieldAnalytic, HollowShellsVoidIsWoundInwards) {
  const SphereSet shell = hollow_shell(300, 5, 1.4);
  const ExtractResult result = extract(shell, at_spacing(0.25));
  expect_sound(result, "hollow shell");
  const reference::MeshFacts facts = facts_of(result);
  EXPECT_EQ(facts.euler_characteristic(), 4);
  EXPECT_EQ(facts.positive_shells, 1u);
  EXPECT_EQ(facts.negative_shells, 1u);
  EXPECT_EQ(facts.genus(), 0);
  if (kind() != FieldKind::vdw) return;
  double void_volume = 0;
  const double exact = shell_volume(shell, &void_volume);
  EXPECT_GT(void_volume, 0.1 * exact);
  // Two walls, each off by about h²/(6 r) times its area, and the dents between the balls.
  EXPECT_NEAR(facts.volume / exact, 1, 0.02);
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorAnalytic);
VDWMESH_INSTANTIATE_FIELDS(ExtractorFieldAnalytic);

}  // namespace
}  // namespace vdwmesh::testing
