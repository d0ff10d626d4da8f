// Exact measures of the solvent-excluded surface of two thousand small sets, general and nearly
// degenerate, and of molecules: soundness, monotony, and counting as the independent judge.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "contract/excluded_measures_contract.hpp"
#include "reference/excluded_grid.hpp"
#include "support/dice.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

// Of a number that is estimated once; the seeds are fixed.
constexpr double kStandardErrors = 5;

// `least` is allowed whatever the estimate says of its error.
void expect_estimate(double value, const reference::Estimate& estimate, double least,
                     const std::string& what) {
  EXPECT_TRUE(std::abs(value - estimate.value) <=
              kStandardErrors * estimate.standard_error() + least)
      << what << " " << value << " is not " << estimate.value << " ± " << estimate.standard_error();
}

// Small areas are estimated from few columns of cells, and an estimate of 0 has no error of its
// own: two columns are allowed for.
void expect_counted(const ExcludedSurface& found, const reference::ExcludedEstimates& counted,
                    double cell) {
  const double least = 2 * cell * cell;
  expect_estimate(found.volume, counted.volume, 0, "volume");
  expect_estimate(found.area, counted.area, 0, "area");
  expect_estimate(found.area_by_kind.contact, counted.contact, least, "contact area");
  expect_estimate(found.area_by_kind.saddle, counted.saddle, least, "saddle area");
  expect_estimate(found.area_by_kind.concave, counted.concave, least, "concave area");
  for (std::size_t k = 0; k < counted.atom_area.size(); ++k) {
    expect_estimate(found.per_atom[k].area.sum(), counted.atom_area[k], least,
                    "area of atom " + std::to_string(k));
  }
}

// Of a small set, to some 1e-3 of its volume and 1 % of its area.
void expect_counted(const ExcludedSurface& found, const std::vector<reference::Ball>& atoms,
                    double probe, unsigned seed) {
  const double cell = 0.07 * std::cbrt(found.volume);
  expect_counted(found, reference::excluded_grid(atoms, probe, {cell, 1, seed}), cell);
}

double probe_for(unsigned seed) {
  constexpr std::array<double, 6> kProbes{1.4, 0.5, 3, 1, 0.1, 10};
  return kProbes[seed / sphere_recipes().size() % kProbes.size()];
}

// Whether a set is in general position within some dozens of Å.
bool is_general(const SeededSet& set) {
  const SphereRecipe& recipe = sphere_recipes()[set.recipe];
  return recipe.position == Position::general && recipe.name != "kilometres apart";
}

std::string label(unsigned seed) {
  const SeededSet set = seeded_set(seed);
  return "seed " + std::to_string(seed) + ", " + std::string(sphere_recipes()[set.recipe].name) +
         ", " + std::to_string(set.spheres.size()) + " atoms, probe " +
         std::to_string(probe_for(seed));
}

// All radii larger by `more`.
double volume_with(const SphereSet& atoms, double more, double probe) {
  std::vector<Sphere> spheres(atoms.spheres().begin(), atoms.spheres().end());
  for (Sphere& s : spheres) s.radius += more;
  return excluded_measures(SphereSet(spheres), {.probe = probe, .shells = false}).complete.volume;
}

// The solid grows with its atoms, so atoms smaller and larger by a hair enclose its volume, even
// where the hair decides whether a probe fits.
void expect_between_neighbours(const SphereSet& atoms, const ExcludedSurface& found, double probe) {
  constexpr double kHair = 1e-5;  // Å
  const double slack = kExcludedRounding * found.accessible_volume;
  EXPECT_GE(found.volume, volume_with(atoms, -kHair, probe) - slack);
  EXPECT_LE(found.volume, volume_with(atoms, kHair, probe) + slack);
}

TEST(ExcludedRandom, TwoThousandSets) {
  constexpr unsigned kSets = 2000;
  for (unsigned seed = 0; seed < kSets && !HasFatalFailure(); ++seed) {
    SCOPED_TRACE(label(seed));
    const SeededSet set = seeded_set(seed);
    const ExcludedMeasures found = measure_excluded(set.spheres, probe_for(seed));
    expect_sound(set.spheres, found);
    EXPECT_TRUE(is_certified(found));
    EXPECT_EQ(found.complete.checks.ties, 0u);
    expect_between_neighbours(set.spheres, found.complete, probe_for(seed));
  }
}

// Sets of general position within some dozens of Å; others are too far apart for a grid, or a hair
// decides about them.
TEST(ExcludedRandom, CountingFindsTheSame) {
  constexpr unsigned kSets = 300;
  for (unsigned seed = 0; seed < kSets; ++seed) {
    const SeededSet set = seeded_set(seed);
    const double probe = std::min(3.0, probe_for(seed));
    if (!is_general(set) || set.spheres.size() > 15) continue;
    SCOPED_TRACE(label(seed));
    const ExcludedSurface found = measure_excluded(set.spheres, probe).complete;
    expect_counted(found, reference_balls(set.spheres), probe, seed);
  }
}

// Atoms much smaller than the probe and so far apart that it all but passes between them: many
// probes are low, many saddles spindles, and many patches in pieces.
std::vector<reference::Ball> loose_atoms(Dice& dice, double probe) {
  const int count = dice.whole(4, 12);
  const double size = 1.1 * probe * std::cbrt(count);
  std::vector<reference::Ball> atoms;
  const auto place = [&] { return dice.real(0, size); };
  for (int k = 0; k < count; ++k) {
    const double x = place(), y = place(), z = place();
    atoms.push_back({{{x, y, z}}, dice.real(0.2, 0.6) * probe});
  }
  return atoms;
}

TEST(ExcludedRandom, LooseAtoms) {
  std::uint64_t probes = 0, low = 0, spindles = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(1000 + seed);
    const double probe = dice.real(1, 3);
    const std::vector<reference::Ball> balls = loose_atoms(dice, probe);
    const SphereSet atoms = to_spheres(balls);
    const ExcludedMeasures found = measure_excluded(atoms, probe);
    expect_sound(atoms, found);
    expect_counted(found.complete, balls, probe, seed);
    probes += found.complete.counts.probes;
    low += found.complete.counts.low_probes;
    spindles += found.complete.counts.spindle_saddles;
  }
  EXPECT_GE(4 * low, probes);
  EXPECT_GE(spindles, 40u);
}

// Atoms copied around an axis, and around axes across it: probes touch copies of several, low ones
// on the axes meet by the dozen.
std::vector<Sphere> dihedral_assembly(Dice& dice, int fold) {
  std::vector<Sphere> atoms;
  for (int count = dice.whole(2, 8); count > 0; --count) {
    const double x = dice.real(0.8, 5), y = dice.real(0, 2), z = dice.real(-3, 3);
    const double radius = dice.real(0.5, 1.8);
    for (int copy = 0; copy < fold; ++copy) {
      const double turn = 2 * std::numbers::pi * copy / fold, c = std::cos(turn),
                   s = std::sin(turn);
      atoms.push_back({{c * x - s * y, s * x + c * y, z}, radius});
      atoms.push_back({{c * x + s * y, s * x - c * y, -z}, radius});
    }
  }
  return atoms;
}

TEST(ExcludedRandom, DihedralAssemblies) {
  std::uint64_t crowded = 0;
  for (const int fold : {2, 3, 4, 5, 6, 12}) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      SCOPED_TRACE(std::to_string(fold) + "-fold, seed " + std::to_string(seed));
      Dice dice(seed);
      const SphereSet atoms(dihedral_assembly(dice, fold));
      const ExcludedMeasures found = measure_excluded(atoms, 0.7 + 0.1 * (seed % 20));
      EXPECT_TRUE(is_certified(found));
      expect_sound(atoms, found);
      crowded += found.complete.counts.crowded_probes;
    }
  }
  EXPECT_GE(crowded, 50u);
}

struct Molecule {
  const char* name;
  double probe;      // Å
  double line_cell;  // Å
};

// Up to a thousand atoms: peptides, proteins, nucleic acids, and benzene and a cube of tangent
// balls, on which a large probe touches four and more at once. Each volume is counted to 1e-4.
constexpr std::array<Molecule, 12> kMolecules{{{"benzene", 1.4, 0.35},
                                               {"cube", 3.0, 0.5},
                                               {"110D", 1.4, 0.9},
                                               {"133D", 1.4, 1.1},
                                               {"1L2Y", 0.7, 1.0},
                                               {"1CRN", 1.4, 1.3},
                                               {"1QL2_chainA", 1.4, 1.2},
                                               {"4PTI", 1.4, 1.4},
                                               {"1BK2", 1.4, 1.5},
                                               {"1ORC", 0.7, 1.3},
                                               {"1UBQ", 1.4, 1.7},
                                               {"1HH0", 1.4, 1.3}}};

void PrintTo(const Molecule& molecule, std::ostream* out) { *out << molecule.name; }

class ExcludedMolecules : public ::testing::TestWithParam<Molecule> {};
INSTANTIATE_TEST_SUITE_P(, ExcludedMolecules, ::testing::ValuesIn(kMolecules),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(ExcludedMolecules, CountingFindsTheSame) {
  const Molecule& molecule = GetParam();
  const std::string file = std::string("reference/") + molecule.name + ".xyzr";
  VDWMESH_NEEDS_SHARED(file);
  const SphereSet atoms = read_xyzr(shared_path(file));
  const ExcludedMeasures found = measure_excluded(atoms, molecule.probe);
  expect_sound(atoms, found);
  EXPECT_TRUE(is_certified(found));
  const reference::ExcludedEstimates counted = reference::excluded_grid(
      reference_balls(atoms), molecule.probe, {.line_cell = molecule.line_cell, .halvings = 3});
  EXPECT_LE(counted.volume.standard_error(), 1e-4 * found.complete.volume);
  expect_counted(found.complete, counted, molecule.line_cell);
}

// With the grown balls given, minus the derivative of the volume by the probe's radius is the area.
// The reference table of this structure and probe is wrong by 1e-9 of it, in one concave patch.
TEST(ExcludedRandom, ADerivativeOfVolumesIsAsGoodAsATable) {
  constexpr double kProbe = 0.7, kStep = 1e-4;  // Å
  // The fourth power of the step; rounding of the volume, over the step.
  constexpr double kDerivative = 1e-10;
  VDWMESH_NEEDS_SHARED("reference/1IZH.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1IZH.xyzr"));
  const auto slope = [&](double step) {
    const auto volume = [&](double probe) { return volume_with(atoms, kProbe - probe, probe); };
    return (volume(kProbe - step) - volume(kProbe + step)) / (2 * step);
  };
  const double area = excluded_measures(atoms, {.probe = kProbe, .shells = false}).complete.area;
  const double derivative = (4 * slope(kStep / 2) - slope(kStep)) / 3;
  EXPECT_NEAR(derivative, area, kDerivative * area);
}

}  // namespace
}  // namespace vdwmesh::testing
