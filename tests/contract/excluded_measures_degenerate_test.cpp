// Exact measures of the solvent-excluded surface where many atoms are tangent to one probe:
// lattices, sheets, stacks, rings and chains, as symmetric as doubles are. Values come from
// counting
// (`excluded_grid.hpp`) and from the same atoms moved by a hair, which are in general position.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "contract/excluded_measures_contract.hpp"
#include "reference/cages.hpp"
#include "reference/excluded_grid.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

using reference::Ball;
using reference::Point;

struct DegenerateSet {
  std::string name;
  std::vector<Ball> atoms;
  double probe;  // Å
};

void PrintTo(const DegenerateSet& set, std::ostream* out) { *out << set.name; }

void add(const std::vector<Point>& centers, double radius, const Point& shift,
         std::vector<Ball>& atoms) {
  for (const Point& c : centers) atoms.push_back({c + shift, radius});
}

// The points of a lattice with a cubic cell of this edge in a cube of `cells` cells, its faces
// included: at the corners, and at the middle of the cell or of its faces.
enum class Lattice { simple, body_centred, face_centred };
std::vector<Ball> lattice(Lattice kind, int cells, double edge, double radius) {
  std::vector<Ball> atoms;
  for (int x = 0; x <= 2 * cells; ++x) {
    for (int y = 0; y <= 2 * cells; ++y) {
      for (int z = 0; z <= 2 * cells; ++z) {
        const bool corner = x % 2 == 0 && y % 2 == 0 && z % 2 == 0;
        const bool middle = x % 2 == 1 && y % 2 == 1 && z % 2 == 1;
        const bool face = !corner && (x + y + z) % 2 == 0;
        const bool is_point = corner || (kind == Lattice::body_centred && middle) ||
                              (kind == Lattice::face_centred && face);
        if (is_point) atoms.push_back({{{x * edge / 2, y * edge / 2, z * edge / 2}}, radius});
      }
    }
  }
  return atoms;
}

std::vector<Point> benzene_ring(double radius) { return reference::regular_polygon(6, radius); }

// Rings of carbon and hydrogen above each other.
std::vector<Ball> stacked_benzene(int rings, double apart) {
  std::vector<Ball> atoms;
  for (int k = 0; k < rings; ++k) {
    add(benzene_ring(1.397), 1.7, {{0, 0, k * apart}}, atoms);
    add(benzene_ring(2.481), 1.2, {{0, 0, k * apart}}, atoms);
  }
  return atoms;
}

// Hexagons that share edges, seven of them: coronene without its hydrogens.
std::vector<Ball> sheet_of_hexagons(double bond) {
  std::vector<Ball> atoms;
  std::vector<Point> middles{{{0, 0, 0}}};
  for (const Point& p : reference::regular_polygon(6, bond * std::sqrt(3.0))) {
    middles.push_back(
        {{p[0] * std::sqrt(0.75) - p[1] * 0.5, p[0] * 0.5 + p[1] * std::sqrt(0.75), 0}});
  }
  for (const Point& middle : middles) {
    for (const Point& p : benzene_ring(bond)) {
      const Point at = middle + p;
      bool is_new = true;
      for (const Ball& atom : atoms) is_new = is_new && distance(atom.center, at) > 0.1 * bond;
      if (is_new) atoms.push_back({at, 1.7});
    }
  }
  return atoms;
}

std::vector<Ball> sheet_of_squares(int side, double edge, double radius) {
  std::vector<Ball> atoms;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) atoms.push_back({{{x * edge, y * edge, 0}}, radius});
  }
  return atoms;
}

std::vector<Ball> chain(int count, double apart, double radius) {
  std::vector<Ball> atoms;
  for (int k = 0; k < count; ++k) atoms.push_back({{{k * apart, 0, 0}}, radius});
  return atoms;
}

std::vector<Ball> cage(const std::vector<Point>& corners, double radius) {
  std::vector<Ball> atoms;
  add(corners, radius, {{0, 0, 0}}, atoms);
  return atoms;
}

std::vector<Ball> with_centre(const std::vector<Point>& corners, double radius) {
  std::vector<Ball> atoms = cage(corners, radius);
  atoms.push_back({{{0, 0, 0}}, radius});
  return atoms;
}

std::vector<DegenerateSet> degenerate_sets() {
  using namespace reference;
  return {// Small atoms far apart: low probes cut each other in planes and points that they share.
          {"tetrahedron of drops", cage(tetrahedron(3.2), 0.6), 1.4},
          {"tetrahedron with a tiny cavity", cage(tetrahedron(3.3), 0.6), 1.4},
          {"octahedron of drops", cage(octahedron(3), 0.6), 1.4},
          {"octahedron, closed", cage(octahedron(2.7), 0.6), 1.4},
          {"cube of drops", cage(cube(2.6), 0.6), 1.4},
          {"icosahedron, low probes", cage(icosahedron(3.2), 0.6), 1.4},
          {"dodecahedron, low probes", cage(dodecahedron(2), 0.6), 1.4},
          {"fullerene, small atoms", cage(fullerene(1.43, 1.43), 0.4), 1.4},
          {"cubic", lattice(Lattice::simple, 2, 3, 1.5), 1.4},
          {"cubic, windows between cells", lattice(Lattice::simple, 2, 4, 1.5), 1.4},
          {"cubic, open", lattice(Lattice::simple, 1, 4.4, 1.5), 1.4},
          {"body-centred", lattice(Lattice::body_centred, 2, 3.5, 1.5), 1.4},
          {"face-centred", lattice(Lattice::face_centred, 1, 4.3, 1.5), 1.4},
          {"face-centred, small probe", lattice(Lattice::face_centred, 1, 4.3, 1.5), 0.4},
          {"face-centred, cavities", lattice(Lattice::face_centred, 2, 5.1, 1.6), 0.9},
          {"stacked benzene", stacked_benzene(3, 3.4), 1.4},
          {"stacked benzene, small probe", stacked_benzene(2, 3.4), 0.7},
          {"benzene far apart", stacked_benzene(2, 5.5), 1.4},
          {"sheet of hexagons", sheet_of_hexagons(1.42), 1.4},
          {"sheet of squares", sheet_of_squares(4, 3, 1.5), 1.4},
          {"sheet of squares with holes", sheet_of_squares(3, 3.7, 1.5), 1.4},
          {"chain", chain(6, 2, 1.5), 1.4},
          {"chain of spindles", chain(5, 5.3, 1.5), 1.4},
          {"ring of eight", cage(regular_polygon(8, 2), 1.5), 1.4},
          {"icosahedron and centre", with_centre(icosahedron(3.2), 1.5), 1.4},
          {"octahedron and centre", with_centre(octahedron(4.2), 1.5), 1.4},
          {"cube and centre", with_centre(cube(3.6), 1.5), 3},
          // The second grown ball touches the first from inside, where the third passes.
          {"touching from inside",
           {{{{-2.5, 1, -2}}, 1.5}, {{{-2, 1, -2}}, 1}, {{{-0.5, -1.5, -2}}, 2}},
           0.5}};
}

class ExcludedDegenerate : public ::testing::TestWithParam<DegenerateSet> {
 protected:
  SphereSet atoms() const { return to_spheres(GetParam().atoms); }
  ExcludedMeasures measured() const { return measure_excluded(atoms(), GetParam().probe); }
};
INSTANTIATE_TEST_SUITE_P(, ExcludedDegenerate, ::testing::ValuesIn(degenerate_sets()),
                         [](const auto& info) {
                           std::string name = info.param.name;
                           for (char& c : name)
                             c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
                           return name;
                         });

// Patches that cannot be certified are reported, but there is no reason for one here.
TEST_P(ExcludedDegenerate, EverythingAgrees) {
  const ExcludedMeasures found = measured();
  expect_sound(atoms(), found);
  EXPECT_TRUE(is_certified(found));
  EXPECT_EQ(found.complete.checks.ties, 0u);
}

// Volume to 2e-3 and area to 3 %.
TEST_P(ExcludedDegenerate, CountingFindsTheSame) {
  constexpr double kErrors = 5;  // standard errors
  const ExcludedSurface found = measured().complete;
  const double cell = 0.07 * std::cbrt(found.volume);
  const reference::ExcludedEstimates counted = reference::excluded_grid(
      GetParam().atoms, GetParam().probe, {.line_cell = cell, .halvings = 1});
  const auto expect = [](double value, const reference::Estimate& estimate) {
    EXPECT_TRUE(std::abs(value - estimate.value) <= kErrors * estimate.standard_error())
        << value << " is not " << estimate.value << " ± " << estimate.standard_error();
  };
  expect(found.volume, counted.volume);
  expect(found.area, counted.area);
  expect(found.area_by_kind.contact, counted.contact);
  expect(found.area_by_kind.saddle, counted.saddle);
  expect(found.area_by_kind.concave, counted.concave);
  EXPECT_LE(counted.volume.standard_error(), 2e-3 * found.volume);
  EXPECT_LE(counted.area.standard_error(), 0.03 * found.area);
}

// Atoms moved so that no probe touches more than three of them: by at most 1e-7 Å, and by less,
// down to where corners are one point for all that double shows. No corner moves a thousand times
// as far as its atoms.
TEST_P(ExcludedDegenerate, MovedByAHair) {
  constexpr double kFarther = 1000;
  const ExcludedSurface before = measured().complete;
  Dice dice(29);
  for (const double move : {1e-7, 1e-9, 1e-10, 1e-12}) {
    SCOPED_TRACE(move);
    std::vector<Ball> moved = GetParam().atoms;
    for (Ball& b : moved) {
      for (double& x : b.center.at) x += dice.real(-move, move);
    }
    const SphereSet shaken = to_spheres(moved);
    const ExcludedMeasures after = measure_excluded(shaken, GetParam().probe);
    EXPECT_TRUE(is_certified(after));
    EXPECT_EQ(after.complete.checks.ties, 0u);
    expect_sound(shaken, after);
    const double slack = kFarther * move * before.area;
    EXPECT_NEAR(after.complete.volume, before.volume, slack + kExcludedRounding * before.volume);
    EXPECT_NEAR(after.complete.area, before.area, slack + kExcludedRounding * before.area);
    expect_same_topology(*after.complete.topology, *before.topology);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
