// Exact measures of the solvent-excluded surface against values from mathematics: few atoms, plane
// rings and convex cages, by quadrature (`excluded_forms.hpp`), and their topology by inspection.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "contract/excluded_measures_contract.hpp"
#include "reference/cages.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {
namespace {

using reference::Ball;
using reference::Cage;
using reference::CageSides;
using reference::ExcludedForm;
using reference::hull_cage;
using std::size_t;

constexpr double kPi = std::numbers::pi;

// Of a pair without a probe that touches more than two atoms.
ExcludedCounts pair_counts(std::uint64_t arcs, std::uint64_t spindles) {
  ExcludedCounts counts{};
  counts.arcs = arcs;
  counts.whole_rings = arcs;
  counts.spindle_saddles = spindles;
  counts.cusps = 2 * spindles;
  return counts;
}

void expect_topology(const ExcludedSurface& found, size_t shells, std::int64_t euler_characteristic,
                     std::uint64_t cavities) {
  ASSERT_TRUE(found.topology.has_value());
  EXPECT_EQ(found.topology->shells.size(), shells);
  EXPECT_EQ(found.topology->euler_characteristic, euler_characteristic);
  EXPECT_EQ(found.topology->cavities, cavities);
}

TEST(ExcludedAnalytic, ABallIsItself) {
  for (const double probe : {0.01, 1.4, 100.0}) {
    const SphereSet atoms({{{1, -2, 3}, 1.7}});
    const ExcludedMeasures found = measure_excluded(atoms, probe);
    expect_sound(atoms, found);
    ExcludedForm ball;
    reference::add_cone(4 * kPi, 1.7, ball);
    expect_form(found.complete, ball);
    expect_topology(found.complete, 1, 2, 0);
    expect_same_counts(found.complete.counts, pair_counts(0, 0));
  }
}

ExcludedMeasures measure_pair(const Ball& a, const Ball& b, double probe) {
  const SphereSet atoms = to_spheres({a, b});
  const ExcludedMeasures found = measure_excluded(atoms, probe);
  expect_sound(atoms, found);
  expect_form(found.complete, excluded_two_balls(a, b, probe));
  return found;
}

// The saddle is a whole ring: atoms that overlap, that touch, and that are apart.
TEST(ExcludedAnalytic, TwoAtomsInAWholeRing) {
  for (const double apart : {0.6, 1.7, 2.7, 3.5, 4.4}) {
    SCOPED_TRACE(apart);
    const ExcludedMeasures found = measure_pair({{{0, 0, 0}}, 1.5}, {{{0, apart, 0}}, 1.2}, 1.4);
    expect_topology(found.complete, 1, 2, 0);
    expect_same_counts(found.complete.counts, pair_counts(1, 0));
  }
}

// Where the probe's circle is smaller than the probe, the saddle ends in two cusps, and the solid
// is two drops.
TEST(ExcludedAnalytic, ASpindleIsTwoDrops) {
  for (const double apart : {4.9, 5.0, 5.4, 5.499}) {
    SCOPED_TRACE(apart);
    const ExcludedMeasures found = measure_pair({{{0, 0, 0}}, 1.5}, {{{0, 0, apart}}, 1.2}, 1.4);
    expect_topology(found.complete, 2, 4, 0);
    expect_same_counts(found.complete.counts, pair_counts(1, 1));
  }
}

// A circle smaller than the probe that does not lie between the atoms: no spindle.
TEST(ExcludedAnalytic, ASmallCircleBeyondASmallAtom) {
  const Ball large{{{0, 0, 0}}, 3}, small{{{2.65, 0, 0}}, 0.4};
  const ExcludedMeasures found = measure_pair(large, small, 4);
  expect_topology(found.complete, 1, 2, 0);
  EXPECT_EQ(found.complete.counts.spindle_saddles, 0u);
}

TEST(ExcludedAnalytic, TwoAtomsApart) {
  for (const double apart : {5.5, 5.500001, 7.0, 1e6}) {
    SCOPED_TRACE(apart);
    const ExcludedMeasures found = measure_pair({{{0, 0, 0}}, 1.5}, {{{apart, 0, 0}}, 1.2}, 1.4);
    expect_topology(found.complete, 2, 4, 0);
    EXPECT_EQ(found.complete.counts.probes, 0u);
  }
}

// The probe's circle as large as the probe itself, between ring and spindle: the saddle touches its
// axis in one point.
TEST(ExcludedAnalytic, TheAreaIsContinuousWhereTheRingBecomesASpindle) {
  const double r = 1.5, probe = 1.4, apart = 2 * std::sqrt(r * r + 2 * r * probe);
  for (const double more : {0.0, -1e-15, 1e-15, -1e-12, 1e-12, -1e-9, 1e-9, -1e-6, 1e-6}) {
    SCOPED_TRACE(more);
    measure_pair({{{0, 0, 0}}, r}, {{{apart * (1 + more), 0, 0}}, r}, probe);
  }
}

// Each atom has its contact patch and the saddle on its side of the plane in which the grown
// spheres meet.
TEST(ExcludedAnalytic, SharesOfTwoAtoms) {
  const Ball a{{{0, 0, 0}}, 1.5}, b{{{1, 2, 0.5}}, 1.2}, far{{{3, 3.5, 1.5}}, 1.2};
  for (const Ball& other : {b, far}) {
    const ExcludedMeasures found = measure_pair(a, other, 1.4);
    const ExcludedForm share = share_of_first(a, other, 1.4);
    const ExcludedAtom& atom = found.complete.per_atom[0];
    EXPECT_RELATIVE(atom.area.contact, share.contact, kExcludedRounding);
    EXPECT_RELATIVE(atom.area.saddle, share.saddle, kExcludedRounding);
    EXPECT_RELATIVE(atom.volume, share.volume, kExcludedRounding);
  }
}

std::array<Ball, 3> three_atoms(double size, double radius) {
  return {{{{{0, 0, 0}}, radius},
           {{{size, 0, 0}}, radius + 0.05},
           {{{size * 0.45, size * 0.9, 0.1}}, radius + 0.1}}};
}

ExcludedMeasures measure_three(const std::array<Ball, 3>& balls, double probe) {
  const SphereSet atoms = to_spheres({balls.begin(), balls.end()});
  const ExcludedMeasures found = measure_excluded(atoms, probe);
  expect_sound(atoms, found);
  expect_form(found.complete, excluded_three_balls(balls, probe));
  EXPECT_EQ(found.complete.counts.probes, 2u);
  EXPECT_EQ(found.complete.counts.arcs, 3u);
  return found;
}

TEST(ExcludedAnalytic, ThreeAtomsWithHighProbes) {
  for (const double size : {1.5, 2.4, 2.8}) {
    SCOPED_TRACE(size);
    const ExcludedMeasures found = measure_three(three_atoms(size, 1.3), 1.4);
    expect_topology(found.complete, 1, 2, 0);
    EXPECT_EQ(found.complete.counts.low_probes, 0u);
    EXPECT_EQ(found.complete.counts.crease_arcs, 0u);
  }
}

// Low mirror probes meet in a circle inside the triangle: the solid has a hole there.
TEST(ExcludedAnalytic, ThreeAtomsWithLowProbesMakeARing) {
  for (const double size : {4.2, 4.4}) {
    SCOPED_TRACE(size);
    const ExcludedMeasures found = measure_three(three_atoms(size, 1.3), 1.4);
    expect_topology(found.complete, 1, 0, 0);
    EXPECT_EQ(found.complete.counts.low_probes, 2u);
    EXPECT_EQ(found.complete.counts.spindle_saddles, 0u);
    EXPECT_EQ(found.complete.counts.crease_arcs, 1u);
  }
}

// If all three saddles are spindles as well, the circle in which the probes meet runs through their
// six cusps, and the solid is three drops.
TEST(ExcludedAnalytic, ThreeAtomsWithSpindlesAreThreeDrops) {
  const ExcludedMeasures found = measure_three(three_atoms(3.6, 0.75), 1.4);
  expect_topology(found.complete, 3, 6, 0);
  EXPECT_EQ(found.complete.counts.spindle_saddles, 3u);
  EXPECT_EQ(found.complete.counts.cusps, 6u);
  EXPECT_EQ(found.complete.counts.crease_arcs, 3u);
}

// From high probes to low ones through the height p, where the two concave patches touch.
TEST(ExcludedAnalytic, MirrorProbesThatTouch) {
  const double r = 1.5, probe = 1.4, grown = r + probe;
  const double side = std::sqrt(3 * (grown * grown - probe * probe));
  for (const double more : {0.0, -1e-15, 1e-15, -1e-12, 1e-12, -1e-8, 1e-8, -1e-4, 1e-4}) {
    SCOPED_TRACE(more);
    const double s = side * (1 + more);
    const std::array<Ball, 3> balls{
        {{{{0, 0, 0}}, r}, {{{s, 0, 0}}, r}, {{{s / 2, s * std::sqrt(0.75), 0}}, r}}};
    const SphereSet atoms = to_spheres({balls.begin(), balls.end()});
    const ExcludedMeasures found = measure_excluded(atoms, probe);
    expect_sound(atoms, found);
    // The circle in which they meet has a radius of √(2 p δ) for δ below the plane, so δ, which is
    // good to 1e-15 Å, makes an area of 1e-14 Å² uncertain.
    expect_form(found.complete, excluded_three_balls(balls, probe));
  }
}

struct CageCase {
  const char* name;
  std::vector<reference::Point> centers;
  double radius, probe;  // Å
  CageSides sides;       // both if the probe has room inside
  size_t shells;
  std::int64_t euler_characteristic;
  std::uint64_t cavities, low_probes, spindles = 0;
};

std::vector<CageCase> cage_cases() {
  using namespace reference;
  const std::vector<Point> carbon = fullerene(1.458, 1.401), regular = fullerene(1.43, 1.43);
  constexpr CageSides kOuter = CageSides::outer, kBoth = CageSides::both;
  return {{"square", regular_polygon(4, 2.8), 1.5, 1.4, kOuter, 1, 2, 0, 0},
          {"square with a hole", regular_polygon(4, 3.7), 1.5, 1.4, kOuter, 1, 0, 0, 2},
          {"pentagon", regular_polygon(5, 1.4), 1.7, 1.4, kOuter, 1, 2, 0, 0},
          {"hexagon", regular_polygon(6, 1.4), 1.7, 1.4, kOuter, 1, 2, 0, 0},
          // The probes on both sides meet in a circle through the cusps of all saddles.
          {"four drops", regular_polygon(4, 2.6), 0.45, 1.4, kOuter, 4, 8, 0, 2, 4},
          {"six drops", regular_polygon(6, 1.5), 0.13, 1.4, kOuter, 6, 12, 0, 2, 6},
          {"tetrahedron", tetrahedron(3), 1.5, 1.4, kOuter, 1, 2, 0, 0},
          {"octahedron", octahedron(3), 1.5, 1.4, kOuter, 1, 2, 0, 0},
          {"cube", cube(3), 1.5, 1.4, kOuter, 1, 2, 0, 0},
          // The probes in front of a face and behind it meet: six windows into the hollow middle.
          {"cube with windows", cube(4), 1.5, 1.4, kBoth, 1, -8, 0, 12},
          {"icosahedron", icosahedron(3.2), 1.5, 1.2, kBoth, 2, 4, 1, 0},
          {"dodecahedron", dodecahedron(2.4), 1.6, 1.4, kBoth, 2, 4, 1, 0},
          {"buckminsterfullerene", carbon, 1.7, 1.4, kBoth, 2, 4, 1, 0},
          {"equal bonds", regular, 1.7, 1.4, kBoth, 2, 4, 1, 0},
          {"buckminsterfullerene, large probe", carbon, 1.7, 3, kOuter, 1, 2, 0, 0}};
}

// Every face has a probe on each side where there is room, every edge an arc.
ExcludedCounts expected_counts(const Cage& cage, const CageCase& c) {
  ExcludedCounts counts{};
  const std::uint64_t sides = c.sides == CageSides::both ? 2 : 1;
  for (const auto& face : cage.faces) {
    counts.probes += sides;
    counts.arcs += sides * face.size();
    if (face.size() > 3) counts.crowded_probes += sides;
  }
  counts.arcs /= 2;
  counts.low_probes = c.low_probes;
  counts.spindle_saddles = c.spindles;
  counts.cusps = 2 * c.spindles;
  counts.crease_arcs = c.spindles > 0 ? c.spindles : c.low_probes / 2;
  return counts;
}

// Of atoms that symmetry makes equal.
void expect_equal_shares(const ExcludedSurface& found) {
  const auto atoms = static_cast<double>(found.per_atom.size());
  for (const ExcludedAtom& atom : found.per_atom) {
    EXPECT_RELATIVE(atom.area.contact, found.area_by_kind.contact / atoms, kExcludedRounding);
    EXPECT_RELATIVE(atom.area.saddle, found.area_by_kind.saddle / atoms, kExcludedRounding);
    EXPECT_RELATIVE(atom.area.concave, found.area_by_kind.concave / atoms, kExcludedRounding);
    EXPECT_RELATIVE(atom.volume, found.volume / atoms, kExcludedRounding);
  }
}

TEST(ExcludedAnalytic, CagesWithCrowdedProbes) {
  for (const CageCase& c : cage_cases()) {
    SCOPED_TRACE(c.name);
    const Cage cage = hull_cage(c.centers);
    const SphereSet atoms = equal_spheres(c.centers, c.radius);
    const ExcludedMeasures found = measure_excluded(atoms, c.probe);
    expect_sound(atoms, found);
    expect_form(found.complete, excluded_cage(cage, c.radius, c.probe, c.sides));
    expect_topology(found.complete, c.shells, c.euler_characteristic, c.cavities);
    expect_same_counts(found.complete.counts, expected_counts(cage, c));
    expect_equal_shares(found.complete);
    EXPECT_EQ(found.complete.topology->components.size(), c.sides == CageSides::both ? 2u : 1u);
  }
}

// Without the probes inside, those outside are cut no longer.
TEST(ExcludedAnalytic, TheOutsideOfCages) {
  for (const CageCase& c : cage_cases()) {
    if (c.sides != CageSides::both) continue;
    SCOPED_TRACE(c.name);
    const ExcludedMeasures found = measure_excluded(equal_spheres(c.centers, c.radius), c.probe);
    ASSERT_TRUE(found.exterior.has_value());
    expect_form(*found.exterior,
                excluded_cage(hull_cage(c.centers), c.radius, c.probe, CageSides::outer));
    expect_topology(*found.exterior, 1, 2, 0);
  }
}

// An atom in the middle of a cage whose grown ball fills the cavity changes nothing outside.
TEST(ExcludedAnalytic, AFillerMakesTheExteriorTheCompleteSurface) {
  std::vector<Ball> balls = reference_balls(equal_spheres(reference::cube(4), 1.5));
  balls.push_back({{{0, 0, 0}}, 0.6});
  const SphereSet atoms = to_spheres(balls);
  const ExcludedMeasures found = measure_excluded(atoms, 1.4);
  expect_sound(atoms, found);
  expect_form(found.complete,
              excluded_cage(hull_cage(reference::cube(4)), 1.5, 1.4, CageSides::outer));
}

// A guest in a cage that the probe cannot enter from outside: a ball with a shell around it.
TEST(ExcludedAnalytic, AGuestInACavity) {
  const std::vector<reference::Point> corners = reference::fullerene(2.2, 2.2);
  std::vector<Ball> balls = reference_balls(equal_spheres(corners, 1.7));
  const SphereSet host = to_spheres(balls);
  balls.push_back({{{0, 0, 0}}, 0.5});
  const SphereSet both = to_spheres(balls);
  const double probe = 0.8;
  const ExcludedMeasures empty = measure_excluded(host, probe),
                         full = measure_excluded(both, probe);
  expect_sound(both, full);
  EXPECT_RELATIVE(full.complete.volume, empty.complete.volume + 4 * kPi / 3 * 0.125,
                  kExcludedRounding);
  EXPECT_RELATIVE(full.complete.area, empty.complete.area + kPi, kExcludedRounding);
  expect_topology(full.complete, 3, 6, 1);
  EXPECT_RELATIVE(full.exterior->volume, empty.exterior->volume, kExcludedRounding);
}

}  // namespace
}  // namespace vdwmesh::testing
