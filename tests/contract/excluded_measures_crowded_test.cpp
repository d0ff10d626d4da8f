// Exact measures of the solvent-excluded surface where probes all but coincide, where they lie in
// the plane of their atoms, and where circles and heights are the probe's radius. Values come from
// quadrature (`excluded_forms.hpp`) of the same atoms or of those next to them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "contract/excluded_measures_contract.hpp"
#include "core/errors.hpp"
#include "reference/cages.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {
namespace {

using reference::Ball;
using reference::CageSides;
using reference::hull_cage;
using reference::Point;

ExcludedMeasures measure_certified(const SphereSet& atoms, double probe) {
  const ExcludedMeasures found = measure_excluded(atoms, probe);
  EXPECT_TRUE(is_certified(found));
  EXPECT_EQ(found.complete.checks.ties, 0u);
  expect_sound(atoms, found);
  return found;
}

void expect_euler_characteristic(const ExcludedMeasures& found, std::int64_t expected) {
  EXPECT_EQ(found.complete.topology->euler_characteristic, expected);
}

// Atoms within 4e-9 Å of a circle and a plane: two probes above 4e-9 Å apart, and their mirror
// images below, all of them on the circle of the atoms 0 and 2.
TEST(ExcludedCrowded, FourAtomsAHairOffACircle) {
  constexpr double kHair = 4e-9, kFarther = 1000;
  const std::vector<Ball> atoms{
      {{{-0.49999999791141747, 0.866025406891614, 1.0742973675581436e-09}}, .34202014220835614},
      {{{-0.93969261585311514, 0.34202014088857646, 1.0806753880136835e-09}}, .34202014332566871},
      {{{0.1736481736905677, -0.98480774868795984, -3.1394028206844013e-09}}, .34202014332566871},
      {{{0.76604444434981367, -0.64278762031545406, 1.3827597444583928e-09}}, .34202014443777728}};
  std::vector<Point> on_circle;
  for (const double degrees : {120, 160, 280, 320}) {
    const double turn = degrees * std::acos(-1.0) / 180;
    on_circle.push_back({{std::cos(turn), std::sin(turn), 0}});
  }
  const ExcludedMeasures found = measure_certified(to_spheres(atoms), 1);
  expect_form(found.complete,
              excluded_cage(hull_cage(on_circle), .34202014332566871, 1, CageSides::outer),
              kFarther * kHair);
}

struct FlatSet {
  const char* name;
  std::vector<Point> corners;  // convex, on a circle about the origin in the plane z = 0
  double radius, probe;        // Å: together the circle's radius
  // With room for the probe to pass, and without.
  std::array<std::int64_t, 2> euler_characteristic;
};

std::vector<FlatSet> flat_sets() {
  const std::vector<Point> square{{{1, 0, 0}}, {{0, 1, 0}}, {{-1, 0, 0}}, {{0, -1, 0}}};
  const std::vector<Point> triangle{{{3, 4, 0}}, {{-3, 4, 0}}, {{0, -5, 0}}};
  const std::vector<Point> four{{{3, 4, 0}}, {{-3, 4, 0}}, {{-4, -3, 0}}, {{0, -5, 0}}};
  const std::vector<Point> rectangle{{{3, 4, 0}}, {{-3, 4, 0}}, {{-3, -4, 0}}, {{3, -4, 0}}};
  return {{"square", square, 0.5, 0.5, {0, 0}},
          {"triangle", triangle, 4, 1, {0, 0}},
          {"four", four, 4, 1, {0, 0}},
          {"hexagon", reference::regular_polygon(6, 1), 0.5, 0.5, {0, 0}},
          // The circle of the upper two atoms is of the probe's radius.
          {"triangle, large probe", triangle, 1, 4, {6, 4}},
          {"four, large probe", four, 1, 4, {6, 4}},
          {"rectangle, large probe", rectangle, 1, 4, {8, 4}}};
}

// A probe in the middle of a ring touches all atoms in their plane. Larger atoms have two probes
// instead, each the mirror image of the other; smaller ones let it pass. Area and volume are the
// same in the limit, from both sides.
TEST(ExcludedCrowded, AProbeInThePlaneOfItsAtoms) {
  // Area and volume change at less than this times their own size per Å of the radius.
  constexpr double kRate = 100, kLarger = 1e-12;  // 1 / Å, Å
  for (const FlatSet& set : flat_sets()) {
    const reference::ExcludedForm limit =
        excluded_cage(hull_cage(set.corners), set.radius + kLarger, set.probe, CageSides::outer);
    for (const double more : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, -1e-9, 1e-6, -1e-6}) {
      SCOPED_TRACE(set.name);
      SCOPED_TRACE(more);
      const SphereSet atoms = equal_spheres(set.corners, set.radius + more);
      const ExcludedMeasures found = measure_certified(atoms, set.probe);
      const double tolerance = kExcludedRounding + kRate * (std::abs(more) + kLarger);
      EXPECT_RELATIVE(found.complete.area, limit.area(), tolerance);
      EXPECT_RELATIVE(found.complete.volume, limit.volume, tolerance);
      // Coordinates of a hexagon are not exact.
      if (std::abs(more) < 1e-14 && (more < 0 || set.corners.size() == 6)) continue;
      expect_euler_characteristic(found, set.euler_characteristic[more >= 0 ? 1 : 0]);
    }
  }
}

// The circle of two atoms, the height of a probe over three, or both, are exactly the probe's
// radius: between a spindle and a ring, between low probes and high ones.
TEST(ExcludedCrowded, CirclesAndHeightsOfTheProbesRadius) {
  const std::array<std::array<Ball, 3>, 3> sets{
      {{{{{{1, -1, 0}}, 0.5}, {{{-1, -1, 0}}, 0.5}, {{{-1, 0, 0}}, 0.5}}},
       {{{{{2, -2, 0}}, 1}, {{{-2, -2, 0}}, 1}, {{{-2, 0, 0}}, 1}}},
       {{{{{2, 0, 0}}, 1}, {{{-1, 2, 0}}, 1}, {{{-1, -2, 0}}, 1}}}}};
  for (const auto& balls : sets) {
    const double probe = 2 * balls[0].radius;
    for (const double more : {0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-8, -1e-8, 1e-4, -1e-4}) {
      SCOPED_TRACE(more);
      std::array<Ball, 3> changed = balls;
      for (Ball& b : changed) b.radius += more;
      const ExcludedMeasures found =
          measure_certified(to_spheres({changed.begin(), changed.end()}), probe);
      expect_form(found.complete, excluded_three_balls(changed, probe));
    }
  }
}

// Atoms in the corners of a row of cubes, at the places where x is not in `left_out`, each as far
// from the middle of its cube as a probe that touches it.
SphereSet row_of_cubes(int cubes, double radius, double probe, int left_out = -1) {
  const double half = (radius + probe) / std::sqrt(3.0);
  std::vector<Sphere> atoms;
  for (int i = 0; i < 4 * (cubes + 1); ++i) {
    if (i == left_out) continue;
    const Vec3d at{i % 2 == 0 ? -half : half, i / 2 % 2 == 0 ? -half : half,
                   half * (i / 4 * 2 - 1)};
    atoms.push_back({at, radius});
  }
  return SphereSet(atoms);
}

// The probe in the middle of a cube touches all atoms around it and cannot roll: its patch is the
// whole sphere, of which atoms that are alike have the same share.
TEST(ExcludedCrowded, AProbeThatItsAtomsHold) {
  const double sphere = 4 * std::acos(-1.0) * 1.4 * 1.4;
  const ExcludedMeasures held = measure_certified(row_of_cubes(1, 1.5, 1.4), 1.4);
  EXPECT_EQ(held.complete.topology->cavities, 1u);
  const double outside = held.exterior->area_by_kind.concave;
  EXPECT_RELATIVE(held.complete.area_by_kind.concave, outside + sphere, kExcludedRounding);
  for (const ExcludedAtom& atom : held.complete.per_atom) {
    EXPECT_RELATIVE(atom.area.concave, (outside + sphere) / 8, kExcludedRounding);
  }
}

// Seven of these atoms hold it too, but probes outside reach its ball through the gap. So its wall
// is a part of the outer surface, and no cavity, and the exterior surface, of probes from outside
// alone, is without it.
TEST(ExcludedCrowded, AProbeThatIsHeldBehindAGap) {
  for (int i = 0; i < 8; ++i) {
    const ExcludedMeasures held = measure_excluded(row_of_cubes(1, 1.5, 1.4, i), 1.4);
    EXPECT_TRUE(is_certified(held));
    EXPECT_EQ(held.complete.checks.ties, 0u);
    EXPECT_EQ(held.complete.topology->cavities, 0u);
    EXPECT_LT(held.complete.volume, held.exterior->volume);
    double shares = 0;
    for (const ExcludedAtom& atom : held.complete.per_atom) shares += atom.area.sum();
    EXPECT_RELATIVE(shares, held.complete.area, kExcludedRounding);
  }
}

// Probes that are held in two cubes overlap each other, and probes outside overlap both.
TEST(ExcludedCrowded, HeldProbesThatOverlap) {
  for (const double radius : {0.5, 0.9, 1.5}) {
    measure_certified(row_of_cubes(2, radius, 2.9 - radius), 2.9 - radius);
  }
}

// Rounding in double may leave nothing of the surface of small atoms under a large probe.
TEST(ExcludedCrowded, SaysWhatRoundingLeavesWrong) {
  const std::vector<Vec3d> places{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}};
  const auto measured = [&](double scale, double probe) {
    std::vector<Sphere> atoms;
    for (const Vec3d& at : places) atoms.push_back({scale * at, scale * 1.7});
    return doubts(excluded_measures(SphereSet(atoms), {.probe = probe, .per_atom = true}).complete);
  };
  EXPECT_TRUE(measured(1, 1.4).empty());
  EXPECT_TRUE(measured(1, 100).empty());
  EXPECT_THROW(measured(1, 1e6), InvalidInput);
  EXPECT_THROW(measured(1e-9, 1.4), InvalidInput);
  // Of what is left at probes between them, something is right to a share that is said.
  std::size_t said = 0;
  for (double probe = 1e4; probe < 1e6; probe *= 3) {
    try {
      said += measured(1, probe).empty() ? 0 : 1;
    } catch (const InvalidInput&) {
    }
  }
  EXPECT_GT(said, 0u);
}

}  // namespace
}  // namespace vdwmesh::testing
