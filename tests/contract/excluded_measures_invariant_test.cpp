// What exact measures of the solvent-excluded surface keep whatever the atoms are: under moves,
// scales and orders, with atoms that add nothing, and between one probe and another.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "contract/excluded_measures_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "measures/exact_union.hpp"
#include "reference/cages.hpp"
#include "support/dice.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {
namespace {

using std::size_t;

struct NamedSet {
  std::string name;
  std::vector<Sphere> atoms;
  double probe;  // Å
};

// Multiples of 2⁻³⁰ Å: a shift by 100 Å is exact.
double rounded(double x) { return std::ldexp(std::round(std::ldexp(x, 30)), -30); }

std::vector<Sphere> random_atoms(unsigned seed, int count, double room) {
  Dice dice(seed);
  const double size = std::cbrt(room * count);
  std::vector<Sphere> atoms;
  const auto place = [&] { return rounded(dice.real(0, size)); };
  for (int k = 0; k < count; ++k) {
    const double x = place(), y = place(), z = place();
    atoms.push_back({{x, y, z}, rounded(dice.real(1.2, 1.9))});
  }
  return atoms;
}

std::vector<Sphere> rounded_spheres(const std::vector<reference::Point>& centers, double radius) {
  std::vector<Sphere> atoms;
  for (const reference::Point& c : centers) {
    atoms.push_back({{rounded(c[0]), rounded(c[1]), rounded(c[2])}, radius});
  }
  return atoms;
}

// In general position: like a protein with high and low probes, sparse, dense; and cages, whose
// coordinates are exact or cut off, so that crowded probes are gathered or all but coincide.
std::vector<NamedSet> sets() {
  return {{"like a protein", random_atoms(1, 60, 12), 1.4},
          {"small probe", random_atoms(2, 40, 15), 0.5},
          {"large probe", random_atoms(3, 60, 20), 4},
          {"sparse", random_atoms(4, 40, 50), 1.4},
          {"dense", random_atoms(5, 60, 4), 1.4},
          {"cube with windows", rounded_spheres(reference::cube(4), 1.5), 1.4},
          {"fullerene cut off", rounded_spheres(reference::fullerene(1.458, 1.401), 1.7), 1.4}};
}

// The corners of `sets()` are good to some 1e-13 Å; those of low probes lose more.
constexpr double kSame = 1e-10;

TEST(ExcludedInvariants, EverythingAgrees) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const SphereSet atoms(set.atoms);
    expect_sound(atoms, measure_excluded(atoms, set.probe));
  }
}

template <class Change>
void expect_same_after(const Change& change, double scale = 1) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const ExcludedMeasures before = measure_excluded(SphereSet(set.atoms), set.probe);
    std::vector<Sphere> changed = set.atoms;
    for (Sphere& s : changed) change(s);
    const ExcludedMeasures after = measure_excluded(SphereSet(changed), scale * set.probe);
    for (const auto& [found, expected] : {std::pair{&after.complete, &before.complete},
                                          std::pair{&*after.exterior, &*before.exterior}}) {
      expect_same_measures(*found, *expected, kSame, scale);
      expect_same_topology(*found->topology, *expected->topology);
      expect_same_counts(found->counts, expected->counts);
    }
  }
}

TEST(ExcludedInvariants, TheOriginDoesNotMatter) {
  expect_same_after([](Sphere& s) { s.center = s.center + Vec3d{100, -100, 100}; });
}

// Axes in another order, and mirrored.
TEST(ExcludedInvariants, TheAxesDoNotMatter) {
  expect_same_after([](Sphere& s) { s.center = {s.center.z, s.center.x, s.center.y}; });
  expect_same_after([](Sphere& s) { s.center = {s.center.x, -s.center.y, s.center.z}; });
}

// Neither does the unit of length: no tolerance is a length.
TEST(ExcludedInvariants, TheUnitDoesNotMatter) {
  for (const double scale : {2.0, 1000.0, 1e-10, 1e10}) {
    SCOPED_TRACE(scale);
    expect_same_after(
        [scale](Sphere& s) {
          s.center = scale * s.center;
          s.radius *= scale;
        },
        scale);
  }
}

TEST(ExcludedInvariants, TheOrderOfAtomsDoesNotMatter) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    std::vector<size_t> order(set.atoms.size());
    std::iota(order.begin(), order.end(), size_t{0});
    Dice dice(17);
    for (size_t k = order.size(); k > 1; --k) {
      std::swap(order[k - 1], order[static_cast<size_t>(dice.whole(0, static_cast<int>(k) - 1))]);
    }
    std::vector<Sphere> shuffled;
    for (const size_t k : order) shuffled.push_back(set.atoms[k]);
    const ExcludedMeasures before = measure_excluded(SphereSet(set.atoms), set.probe),
                           after = measure_excluded(SphereSet(shuffled), set.probe);
    expect_same_measures(after.complete, before.complete, kSame);
    expect_same_topology(*after.complete.topology, *before.complete.topology);
    expect_same_counts(after.complete.counts, before.complete.counts);
    const double area = kSame * before.complete.area, volume = kSame * before.complete.volume;
    for (size_t k = 0; k < order.size(); ++k) {
      const ExcludedAtom &a = after.complete.per_atom[k], &b = before.complete.per_atom[order[k]];
      EXPECT_NEAR(a.area.contact, b.area.contact, area);
      EXPECT_NEAR(a.area.saddle, b.area.saddle, area);
      EXPECT_NEAR(a.area.concave, b.area.concave, area);
      EXPECT_NEAR(a.volume, b.volume, volume);
    }
  }
}

// The same bits.
void expect_identical(const ExcludedSurface& a, const ExcludedSurface& b) {
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.checks.closure, b.checks.closure);
  EXPECT_EQ(a.checks.check_volume, b.checks.check_volume);
  ASSERT_EQ(a.per_atom.size(), b.per_atom.size());
  for (size_t k = 0; k < a.per_atom.size(); ++k) {
    EXPECT_EQ(a.per_atom[k].area.sum(), b.per_atom[k].area.sum());
    EXPECT_EQ(a.per_atom[k].volume, b.per_atom[k].volume);
  }
}

TEST(ExcludedInvariants, TheNumberOfThreadsDoesNotMatter) {
  const SphereSet atoms(random_atoms(6, 300, 12));
  const ExcludedMeasures many = measure_excluded(atoms, 1.4);
  expect_sound(atoms, many);
  for (const size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ExcludedMeasures found = measure_excluded(atoms, 1.4);
    expect_identical(found.complete, many.complete);
    expect_identical(*found.exterior, *many.exterior);
  }
}

// The table of atoms changes no total, and what is not wanted is not there.
TEST(ExcludedInvariants, OptionsDoNotChangeTheTotals) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const SphereSet atoms(set.atoms);
    const ExcludedMeasures all = measure_excluded(atoms, set.probe);
    const ExcludedMeasures tabled =
        excluded_measures(atoms, {.probe = set.probe, .per_atom = true});
    expect_identical(tabled.complete, all.complete);
    EXPECT_FALSE(tabled.exterior.has_value());
    const ExcludedMeasures totals = excluded_measures(atoms, {.probe = set.probe, .shells = false});
    EXPECT_EQ(totals.complete.area, all.complete.area);
    EXPECT_EQ(totals.complete.volume, all.complete.volume);
    EXPECT_FALSE(totals.complete.topology.has_value());
    EXPECT_TRUE(totals.complete.per_atom.empty());
  }
}

// Of equal atoms the first owns everything; an atom inside another owns nothing.
TEST(ExcludedInvariants, AtomsThatAddNothing) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const ExcludedMeasures before = measure_excluded(SphereSet(set.atoms), set.probe);
    std::vector<Sphere> more = set.atoms;
    for (const Sphere& s : set.atoms) {
      more.push_back(s);
      more.push_back({s.center, s.radius / 2});
      more.push_back({s.center + Vec3d{s.radius / 4, 0, 0}, s.radius / 2});
    }
    const SphereSet atoms(more);
    const ExcludedMeasures after = measure_excluded(atoms, set.probe);
    expect_sound(atoms, after);
    expect_same_measures(after.complete, before.complete, kSame);
    expect_same_topology(*after.complete.topology, *before.complete.topology);
    expect_same_counts(after.complete.counts, before.complete.counts);
    for (size_t k = set.atoms.size(); k < more.size(); ++k) {
      EXPECT_EQ(after.complete.per_atom[k].area.sum(), 0) << k;
      EXPECT_NEAR(after.complete.per_atom[k].volume, 0, kSame * after.complete.volume) << k;
    }
  }
}

// An atom that touches another from inside, the largest that adds nothing.
TEST(ExcludedInvariants, AnAtomThatTouchesFromInside) {
  const std::vector<Sphere> one{{{0, 0, 0}, 2}};
  const SphereSet both({{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1.5}});
  const ExcludedMeasures found = measure_excluded(both, 1.4);
  expect_sound(both, found);
  expect_same_measures(found.complete, measure_excluded(SphereSet(one), 1.4).complete);
}

// Far groups do not know of each other.
TEST(ExcludedInvariants, GroupsApartAddUp) {
  const std::vector<Sphere> first = random_atoms(1, 60, 12), second = random_atoms(4, 40, 50);
  std::vector<Sphere> both = first;
  for (Sphere s : second) {
    s.center = s.center + Vec3d{1000, 0, 0};
    both.push_back(s);
  }
  const ExcludedSurface a = measure_excluded(SphereSet(first), 1.4).complete,
                        b = measure_excluded(SphereSet(second), 1.4).complete,
                        sum = measure_excluded(SphereSet(both), 1.4).complete;
  EXPECT_RELATIVE(sum.area, a.area + b.area, kSame);
  EXPECT_RELATIVE(sum.volume, a.volume + b.volume, kSame);
  EXPECT_EQ(sum.topology->euler_characteristic,
            a.topology->euler_characteristic + b.topology->euler_characteristic);
  EXPECT_EQ(sum.topology->shells.size(), a.topology->shells.size() + b.topology->shells.size());
}

// A move of all atoms by at most 1e-7 Å. The solid changes by what its surface and the probes'
// places move: sets() has no corner that moves a thousand times as far as its atoms.
TEST(ExcludedInvariants, ASmallMoveMakesASmallDifference) {
  constexpr double kMove = 1e-7, kFarther = 1000;
  Dice dice(23);
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const ExcludedSurface before = measure_excluded(SphereSet(set.atoms), set.probe).complete;
    std::vector<Sphere> moved = set.atoms;
    for (Sphere& s : moved) {
      for (int k = 0; k < 3; ++k) s.center[k] += dice.real(-kMove, kMove);
    }
    const ExcludedSurface after = measure_excluded(SphereSet(moved), set.probe).complete;
    EXPECT_NEAR(after.volume, before.volume, kFarther * kMove * before.area);
    EXPECT_NEAR(after.area, before.area, kFarther * kMove * before.area);
    expect_same_topology(*after.topology, *before.topology);
    EXPECT_EQ(after.counts.low_probes == 0, before.counts.low_probes == 0);
  }
}

constexpr double kShell = 5;  // Å

Vec3d spread_direction(int k, int count) {
  const double z = 1 - (2 * k + 1.0) / count, turn = k * std::numbers::pi * (3 - std::sqrt(5.0));
  const double off = std::sqrt(1 - z * z);
  return {off * std::cos(turn), off * std::sin(turn), z};
}

std::vector<Sphere> hollow_atoms(unsigned seed) {
  Dice dice(seed);
  const int count = dice.whole(30, 60);
  std::vector<Sphere> atoms;
  for (int k = 0; k < count; ++k) {
    Vec3d at = kShell * spread_direction(k, count);
    for (int axis = 0; axis < 3; ++axis) at[axis] += dice.real(-0.3, 0.3);
    atoms.push_back({at, dice.real(1.2, 1.8)});
  }
  return atoms;
}

// Whether no probe's centre can be on the sphere of radius `kShell`: it is covered by more than the
// distance from any point to the next one that is looked at.
bool is_closed_shell(const std::vector<Sphere>& atoms, double probe) {
  constexpr int kPoints = 20000;
  constexpr double kBetween = 0.1;  // Å
  for (int k = 0; k < kPoints; ++k) {
    const Vec3d at = kShell * spread_direction(k, kPoints);
    const bool covered = std::any_of(atoms.begin(), atoms.end(), [&](const Sphere& s) {
      return norm(at - s.center) < s.radius + probe - kBetween;
    });
    if (!covered) return false;
  }
  return true;
}

// A shell that a probe cannot pass has the exterior surface of the same shell with a ball in it,
// which leaves no room for probes. In thin shells, probes inside cut those outside.
TEST(ExcludedInvariants, TheExteriorIsThatOfAFilledShell) {
  int closed = 0;
  std::uint64_t low = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    std::vector<Sphere> atoms = hollow_atoms(seed);
    const double probe = 0.8 + 0.05 * (seed % 20);
    if (!is_closed_shell(atoms, probe)) continue;
    const ExcludedMeasures hollow = measure_excluded(SphereSet(atoms), probe);
    expect_sound(SphereSet(atoms), hollow);
    atoms.push_back({{0, 0, 0}, kShell - probe});
    const ExcludedMeasures filled = measure_excluded(SphereSet(atoms), probe);
    expect_sound(SphereSet(atoms), filled);
    expect_same_measures(*hollow.exterior, filled.complete, kSame);
    expect_same_topology(*hollow.exterior->topology, *filled.complete.topology);
    ++closed;
    low += filled.complete.counts.low_probes;
  }
  EXPECT_GE(closed, 10);
  EXPECT_GE(low, 5u);
}

// With the grown balls of radius R given, the solid for the probe q is what is at least q from all
// accessible places, so by the coarea formula its volume falls with q at the rate of its area.
struct GrownBalls {
  std::vector<Sphere> balls;

  ExcludedSurface shrunk_by(double probe) const {
    std::vector<Sphere> atoms = balls;
    for (Sphere& s : atoms) s.radius -= probe;
    return excluded_measures(SphereSet(atoms), {.probe = probe, .shells = false}).complete;
  }
};

TEST(ExcludedInvariants, TheAreaIsTheDerivativeOfTheVolume) {
  // Three nodes of Gauss–Legendre quadrature, exact for polynomials of degree 5. Where a patch
  // comes or goes within the step, the area has a bend; it is smaller than 1e-7 of it.
  constexpr double kStep = 1e-3, kBend = 1e-7;
  const std::array<double, 3> nodes{-std::sqrt(0.6), 0, std::sqrt(0.6)}, weights{5, 8, 5};
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    GrownBalls grown{set.atoms};
    for (Sphere& s : grown.balls) s.radius += set.probe;
    double area = 0;
    for (size_t k = 0; k < 3; ++k) {
      area += weights[k] / 18 * grown.shrunk_by(set.probe + kStep / 2 * nodes[k]).area;
    }
    const double less = grown.shrunk_by(set.probe - kStep / 2).volume -
                        grown.shrunk_by(set.probe + kStep / 2).volume;
    EXPECT_RELATIVE(less / kStep, area, kBend);
  }
}

// The same over all probes, down to none: the areas determine the volume.
TEST(ExcludedInvariants, TheAreasOfAllProbesAreTheLayer) {
  constexpr int kSteps = 200;
  constexpr double kSimpson = 1e-5;  // relative: steps of 0.007 Å, with bends of the area
  const NamedSet set = sets().front();
  GrownBalls grown{set.atoms};
  for (Sphere& s : grown.balls) s.radius += set.probe;
  const double step = (set.probe - 0.01) / kSteps;
  double layer = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double weight = k == 0 || k == kSteps ? 1 : (k % 2 == 1 ? 4 : 2);
    layer += weight * step / 3 * grown.shrunk_by(0.01 + step * k).area;
  }
  const double less = grown.shrunk_by(0.01).volume - grown.shrunk_by(set.probe).volume;
  EXPECT_RELATIVE(layer, less, kSimpson);
}

// What a large probe reaches a small one reaches too.
TEST(ExcludedInvariants, TheSolidGrowsWithTheProbe) {
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    double before = 0;
    for (const double probe : {1e-6, 0.01, 0.1, 0.3, 0.7, 1.4, 2.0, 3.0, 6.0, 20.0, 100.0}) {
      const double volume =
          excluded_measures(SphereSet(set.atoms), {.probe = probe}).complete.volume;
      EXPECT_GE(volume, before * (1 - kExcludedRounding)) << probe;
      before = volume;
    }
  }
}

// Area and volume differ from the union's in proportion to the probe, so twice the value for half a
// probe less the value for a whole one is wrong by its square.
TEST(ExcludedInvariants, ASmallProbeTendsToTheUnionOfTheAtoms) {
  constexpr double kProbe = 1e-4, kSquare = 1e-6;
  for (const NamedSet& set : sets()) {
    SCOPED_TRACE(set.name);
    const SphereSet atoms(set.atoms);
    const ExactUnion expected = exact_union(atoms);
    const ExcludedSurface half = excluded_measures(atoms, {.probe = kProbe / 2}).complete,
                          whole = excluded_measures(atoms, {.probe = kProbe}).complete;
    EXPECT_RELATIVE(2 * half.area - whole.area, expected.area, kSquare);
    EXPECT_RELATIVE(2 * half.volume - whole.volume, expected.volume, kSquare);
    EXPECT_RELATIVE(whole.area_by_kind.contact, expected.area, 1e-2);
  }
}

// The convex hull of equal balls by Steiner's formula: of the hull of their centres, volume, area
// and the sum of edge lengths times the angles between the faces' normals.
struct HullMeasures {
  double area, volume;
};

HullMeasures hull_of_balls(const std::vector<reference::Point>& corners, double r) {
  constexpr double kPi = std::numbers::pi;
  const reference::Cage hull = reference::hull_cage(corners);
  double volume = 0, area = 0, edges = 0;
  std::vector<reference::Point> normals;
  for (const auto& face : hull.faces) {
    reference::Point twice{{0, 0, 0}};
    for (size_t k = 0; k < face.size(); ++k) {
      twice = twice + outer(corners[face[k]], corners[face[(k + 1) % face.size()]]);
    }
    area += length(twice) / 2;
    volume += inner(corners[face[0]], twice) / 6;
    normals.push_back((1 / length(twice)) * twice);
  }
  for (size_t f = 0; f < hull.faces.size(); ++f) {
    for (size_t g = 0; g < f; ++g) {
      std::vector<size_t> shared;
      for (const size_t k : hull.faces[f]) {
        const auto& other = hull.faces[g];
        if (std::find(other.begin(), other.end(), k) != other.end()) shared.push_back(k);
      }
      if (shared.size() != 2) continue;
      const double angle =
          std::atan2(length(outer(normals[f], normals[g])), inner(normals[f], normals[g]));
      edges += angle * distance(corners[shared[0]], corners[shared[1]]);
    }
  }
  return {area + edges * r + 4 * kPi * r * r,
          volume + area * r + edges * r * r / 2 + 4 * kPi / 3 * r * r * r};
}

// A flat part of the hull is bent by its extent squared over the probe's radius, so the differences
// go as 1 / p, and twice the value for 2 p less that for p is wrong by some (extent / p)².
TEST(ExcludedInvariants, ALargeProbeTendsToTheConvexHull) {
  constexpr double kProbe = 3e3, kBending = 1e-4;
  Dice dice(31);
  std::vector<reference::Point> corners;
  for (int k = 0; k < 25; ++k) {
    const double z = dice.real(-1, 1), turn = dice.real(0, 2 * std::numbers::pi);
    const double off = std::sqrt(1 - z * z);
    corners.push_back({{5 * off * std::cos(turn), 4 * off * std::sin(turn), 4.5 * z}});
  }
  const HullMeasures expected = hull_of_balls(corners, 1.5);
  corners.push_back({{0.1, 0.2, 0.3}});
  const SphereSet atoms = equal_spheres(corners, 1.5);
  const ExcludedMeasures once = measure_excluded(atoms, kProbe),
                         twice = measure_excluded(atoms, 2 * kProbe);
  EXPECT_EQ(once.complete.topology->euler_characteristic, 2);
  EXPECT_RELATIVE(once.complete.volume, expected.volume, 10.0 / kProbe);
  EXPECT_RELATIVE(once.complete.area, expected.area, 10.0 / kProbe);
  EXPECT_RELATIVE(2 * twice.complete.volume - once.complete.volume, expected.volume, kBending);
  EXPECT_RELATIVE(2 * twice.complete.area - once.complete.area, expected.area, kBending);
}

TEST(ExcludedInvariants, RefusesWhatHasNoSurface) {
  const SphereSet atoms(random_atoms(1, 5, 12));
  EXPECT_THROW(excluded_measures(SphereSet{}), InvalidInput);
  for (const double probe : {0.0, -0.0, -1.4, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e31}) {
    EXPECT_THROW(excluded_measures(atoms, {.probe = probe}), InvalidInput) << probe;
  }
}

class Stopped final : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

TEST(ExcludedInvariants, StopsWhenAsked) {
  Stopped monitor;
  EXPECT_THROW(excluded_measures(SphereSet(random_atoms(6, 300, 12)), {.monitor = &monitor}),
               Cancelled);
}

}  // namespace
}  // namespace vdwmesh::testing
