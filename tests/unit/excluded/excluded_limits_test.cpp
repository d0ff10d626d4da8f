// Where the excluded surface tends to something known: small and large probes, shaken sets, sets
// moved away from the origin; and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "excluded/excluded_measures.hpp"
#include "excluded/probes/low_probes.hpp"
#include "excluded/probes/wide_probes.hpp"
#include "measures/exact_union.hpp"
#include "reference/cages.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Sphere> atoms_at(const std::vector<reference::Point>& centers, double radius) {
  std::vector<Sphere> atoms;
  for (const reference::Point& c : centers) atoms.push_back({{c[0], c[1], c[2]}, radius});
  return atoms;
}

// Chains of overlapping atoms of some radii, with their neighbours at random places.
std::vector<Sphere> heap(unsigned seed, int count) {
  Dice dice(seed);
  std::vector<Sphere> atoms;
  for (int i = 0; i < count; ++i) {
    const double x = dice.real(-4, 4), y = dice.real(-4, 4), z = dice.real(-4, 4);
    atoms.push_back({{x, y, z}, dice.real(1.1, 1.9)});
  }
  return atoms;
}

ExcludedSurface surface_of(const std::vector<Sphere>& atoms, double probe, bool per_atom = false) {
  ExcludedOptions options;
  options.probe = probe;
  options.per_atom = per_atom;
  return excluded_measures(SphereSet(atoms), options).complete;
}

// The layer between the union and the excluded solid lies in creases: its area is of the order of
// the probe times the length of all creases, some hundred Å here, and the volume a power higher.
TEST(ExcludedLimits, SmallProbesTendToTheUnion) {
  constexpr double kCreases = 1000;  // Å
  for (const unsigned seed : {1u, 2u, 3u}) {
    const std::vector<Sphere> atoms = heap(seed, 40);
    const ExactUnion u = exact_union(SphereSet(atoms));
    for (const double probe : {1e-2, 1e-3, 1e-4}) {
      const ExcludedSurface s = surface_of(atoms, probe);
      EXPECT_NEAR(s.area, u.area, kCreases * probe);
      EXPECT_NEAR(s.volume, u.volume, kCreases * probe * probe);
    }
  }
}

// Buckminsterfullerene of small atoms, moved by lengths about which corners are one point or not:
// the measures are those of the cage in place, but for some times as much as it was moved.
TEST(ExcludedLimits, FullerenesMovedByAHairAreThoseInPlace) {
  constexpr double kMoved = 1e-8;
  for (const auto& [bond, radius] : {std::pair{1.4, 0.8}, {1.45, 0.75}, {1.4, 1.0}, {1.45, 1.2}}) {
    const std::vector<Sphere> cage = atoms_at(reference::fullerene(bond, bond), radius);
    for (const double probe : {0.7, 1.4}) {
      const ExcludedSurface in_place = surface_of(cage, probe);
      for (const double move : {1e-12, 1e-11, 3e-11, 1e-10, 1e-9}) {
        for (unsigned seed = 0; seed < 4; ++seed) {
          SCOPED_TRACE(::testing::Message() << bond << ", " << radius << ", probe " << probe
                                            << ", moved by " << move << ", seed " << seed);
          Dice dice(seed);
          std::vector<Sphere> moved = cage;
          for (Sphere& s : moved) {
            s.center = s.center + Vec3d{dice.real(-move, move), dice.real(-move, move),
                                        dice.real(-move, move)};
          }
          const ExcludedSurface found = surface_of(moved, probe);
          EXPECT_EQ(found.checks.uncertified_patches, 0u);
          EXPECT_NEAR(found.area, in_place.area, kMoved * in_place.area);
          EXPECT_NEAR(found.volume, in_place.volume, kMoved * in_place.volume);
          EXPECT_EQ(found.euler_characteristic, in_place.euler_characteristic);
        }
      }
    }
  }
}

// The convex hull of eight equal balls on the corners of a cube, by Steiner's formula. Concave
// patches sag below the hull's faces by edge² / 4 probe or less. (Rounding grows with the cube of
// the probe, because the solid angles of patches shrink with its square.)
TEST(ExcludedLimits, LargeProbesTendToTheConvexHull) {
  constexpr double kEdge = 3, kRadius = 1.6;
  const double volume = std::pow(kEdge, 3) + 6 * kEdge * kEdge * kRadius +
                        3 * kPi * kEdge * kRadius * kRadius + 4 * kPi / 3 * std::pow(kRadius, 3);
  const double area = 6 * kEdge * kEdge + 6 * kPi * kEdge * kRadius + 4 * kPi * kRadius * kRadius;
  for (const double probe : {1e2, 1e3, 1e4}) {
    const ExcludedSurface s = surface_of(atoms_at(reference::cube(kEdge), kRadius), probe);
    EXPECT_NEAR(s.volume, volume, area * kEdge * kEdge / (4 * probe));
    EXPECT_NEAR(s.area, area, area * kEdge / probe);
    EXPECT_EQ(s.topology->euler_characteristic, 2);
    EXPECT_EQ(s.counts.probes, 6u);
    EXPECT_EQ(s.counts.crowded_probes, 6u);
  }
}

// Cages whose faces have four, five or six atoms: unshaken, and moved by 1e-7 Å, after which every
// probe touches three atoms. Areas change by that times the number of atoms and some Å, except that
// circles of radius near 0 have square roots. The shares of atoms do change: a probe over a hexagon
// divides its patch among six atoms, one of the four probes beside it in the shaken set among
// three. Unshaken, atoms that the cage's symmetry exchanges have equal shares.
TEST(ExcludedLimits, ShakenCagesHaveTheSameMeasures) {
  constexpr double kShake = 1e-7, kChange = 1e-4;  // Å, Å² or Å³
  constexpr double kEqualShares = 1e-9;            // Å² or Å³
  for (const auto& centers : {reference::cube(2.8), reference::fullerene(1.45, 1.4),
                              reference::dodecahedron(1.6), reference::regular_polygon(6, 1.4)}) {
    const std::vector<Sphere> atoms = atoms_at(centers, 1.7);
    std::vector<Sphere> shaken = atoms;
    Dice dice(5);
    for (Sphere& s : shaken) {
      for (int k = 0; k < 3; ++k) s.center[k] += dice.real(-kShake, kShake);
    }
    for (const double probe : {0.5, 1.4, 3.0}) {
      SCOPED_TRACE(std::to_string(centers.size()) + " atoms, probe " + std::to_string(probe));
      const ExcludedSurface a = surface_of(atoms, probe, true), b = surface_of(shaken, probe);
      EXPECT_NEAR(a.area, b.area, kChange);
      EXPECT_NEAR(a.volume, b.volume, kChange);
      EXPECT_EQ(a.topology->euler_characteristic, b.topology->euler_characteristic);
      EXPECT_EQ(a.checks.uncertified_patches + b.checks.uncertified_patches, 0u);
      for (const ExcludedAtom& atom : a.per_atom) {
        EXPECT_NEAR(atom.area.sum(), a.area / static_cast<double>(atoms.size()), kEqualShares);
        EXPECT_NEAR(atom.volume, a.volume / static_cast<double>(atoms.size()), kEqualShares);
      }
    }
  }
}

TEST(ExcludedLimits, PlacesFarFromTheOriginChangeNothing) {
  constexpr double kShift = 128;  // Å: exact for coordinates of few bits
  constexpr double kRelative = 1e-12;
  std::vector<Sphere> atoms = heap(7, 60);
  for (Sphere& s : atoms) {
    for (int k = 0; k < 3; ++k) s.center[k] = std::round(s.center[k] * 1024) / 1024;
  }
  const ExcludedSurface here = surface_of(atoms, 1.4);
  for (Sphere& s : atoms) s.center = s.center + Vec3d{kShift, -kShift, kShift};
  const ExcludedSurface there = surface_of(atoms, 1.4);
  EXPECT_NEAR(there.volume, here.volume, kRelative * here.volume);
  EXPECT_NEAR(there.area, here.area, kRelative * here.area);
}

TEST(ExcludedLimits, RefusesWhatIsNoProbe) {
  const std::vector<Sphere> atoms = heap(1, 3);
  for (const double probe : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity(), 1e31}) {
    EXPECT_THROW(surface_of(atoms, probe), InvalidInput) << probe;
  }
  EXPECT_THROW(excluded_measures(SphereSet()), InvalidInput);
}

// Beyond 2^53 a cell has no neighbours of other numbers.
TEST(ExcludedLimits, CellsOfAnyNumber) {
  const auto numbers = [](double home) {
    std::vector<double> visited;
    excluded::visit_cells_beside(home, [&](double cell) { visited.push_back(cell); });
    return visited;
  };
  EXPECT_EQ(numbers(-1), (std::vector<double>{-2, -1, 0}));
  EXPECT_EQ(numbers(1e300), (std::vector<double>{1e300}));
  EXPECT_EQ(numbers(-1e17), (std::vector<double>{-1e17}));
}

// Roots by Newton's method have the digits of those of the library.
TEST(ExcludedLimits, RootsOfWideNumbers) {
  Dice dice(49);
  for (int i = 0; i < 300; ++i) {
    const WideFloat x = dice.real(1, 4) + WideFloat(dice.real(0, 1)) * WideFloat(0x1p-60);
    for (const WideFloat& scaled : {x, WideFloat(x * WideFloat(1e-120)), WideFloat(x * 1e200)}) {
      const WideFloat root = sqrt(scaled), apart = excluded::root_of(scaled) - root;
      EXPECT_LE(static_cast<double>(WideFloat(abs(apart) / root)), 1e-98);
    }
  }
  EXPECT_EQ(excluded::root_of(WideFloat(0)), 0);
}

}  // namespace
}  // namespace vdwmesh::testing
