// Excluded surfaces of many sets in one call, on every backend: closed forms by quadrature, the
// dual complex as the reference, batches, determinism, and input that must be refused.
#include "excluded/excluded_measurer.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "reference/excluded_forms.hpp"
#include "support/dice.hpp"
#include "support/excluded_batches.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

class ExcludedMeasurerContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  ExcludedBatch measure(const std::vector<Sphere>& atoms, double probe,
                        const std::vector<std::size_t>& offsets = {}) const {
    return make_excluded_measurer(GetParam())
        ->measure({.spheres = atoms.data(), .size = atoms.size(), .offsets = offsets}, probe);
  }
  void expect_reference(const std::vector<Sphere>& atoms, double probe) const {
    expect_same(measure(atoms, probe), reference_of(atoms, probe));
  }
  // And on the backend itself.
  void expect_own_reference(const std::vector<Sphere>& atoms, double probe) const {
    const ExcludedBatch found = measure(atoms, probe), expected = reference_of(atoms, probe);
    expect_same(found, expected);
    expect_little_help(found, expected);
  }
  static ExcludedBatch reference_of(const std::vector<Sphere>& atoms, double probe) {
    return make_cpu_excluded_measurer()->measure({.spheres = atoms.data(), .size = atoms.size()},
                                                 probe);
  }
};
VDWMESH_INSTANTIATE_BACKENDS(ExcludedMeasurerContract);

std::vector<Sphere> molecule(const std::string& name) {
  return spheres_of(read_xyzr(shared_path("reference/" + name)));
}

std::vector<Sphere> plain(const std::vector<reference::Ball>& balls) {
  std::vector<Sphere> out;
  for (const reference::Ball& b : balls) {
    out.push_back({{b.center[0], b.center[1], b.center[2]}, b.radius});
  }
  return out;
}

void expect_form(const ExcludedTotals& found, const reference::ExcludedForm& expected) {
  const double area = kSameExcluded * found.accessible_area;
  EXPECT_NEAR(found.area_by_kind.contact, expected.contact, area);
  EXPECT_NEAR(found.area_by_kind.saddle, expected.saddle, area);
  EXPECT_NEAR(found.area_by_kind.concave, expected.concave, area);
  EXPECT_NEAR(found.volume, expected.volume, kSameExcluded * found.accessible_volume);
}

TEST_P(ExcludedMeasurerContract, OneBallIsItself) {
  const ExcludedBatch found = measure({{{1, -2, 3}, 1.7}}, 1.4);
  const double area = 4 * std::numbers::pi * 1.7 * 1.7;
  EXPECT_NEAR(found.totals[0].area, area, 1e-13 * area);
  EXPECT_NEAR(found.totals[0].volume, area * 1.7 / 3, 1e-13 * area);
  EXPECT_EQ(found.totals[0].euler_characteristic, 2);
}

// Rings, spindles, and balls that a probe passes between.
TEST_P(ExcludedMeasurerContract, TwoBallsHaveTheirForms) {
  for (const double apart : {1.0, 2.5, 4.0, 5.5, 5.7, 7.0}) {
    SCOPED_TRACE(apart);
    const std::vector<reference::Ball> balls{{{0, 0, 0}, 1.5}, {{apart, 0, 0}, 1.3}};
    const ExcludedTotals found = measure(plain(balls), 1.4).totals[0];
    expect_form(found, reference::excluded_two_balls(balls[0], balls[1], 1.4));
    // A spindle and a gap leave two spheres.
    EXPECT_EQ(found.euler_characteristic, apart > 4.2 ? 4 : 2);
  }
}

TEST_P(ExcludedMeasurerContract, ThreeBallsHaveTheirForms) {
  for (const double height : {2.0, 2.7, 3.4}) {
    SCOPED_TRACE(height);
    const std::array<reference::Ball, 3> balls{
        {{{0, 0, 0}, 1.5}, {{3.0, 0, 0}, 1.4}, {{1.3, height, 0}, 1.6}}};
    const ExcludedTotals found =
        measure(plain(std::vector<reference::Ball>(balls.begin(), balls.end())), 1.4).totals[0];
    expect_form(found, reference::excluded_three_balls(balls, 1.4));
    EXPECT_EQ(found.counts.probes, 2u);
  }
}

TEST_P(ExcludedMeasurerContract, MoleculesAreThoseOfTheDualComplex) {
  if (GetParam() == Backend::cpu) GTEST_SKIP() << "the backend compared with";
  VDWMESH_NEEDS_SHARED("reference");
  for (const char* name : {"1L2Y", "1CRN", "110D", "1UBQ", "1EJG", "cube", "benzene"}) {
    for (const double probe : {0.7, 1.4, 3.0}) {
      SCOPED_TRACE(std::string(name) + ", probe " + std::to_string(probe));
      expect_own_reference(molecule(std::string(name) + ".xyzr"), probe);
    }
  }
  expect_own_reference(molecule("4HHB.xyzr"), 1.4);
}

TEST_P(ExcludedMeasurerContract, RandomSetsAreThoseOfTheDualComplex) {
  if (GetParam() == Backend::cpu) GTEST_SKIP() << "the backend compared with";
  for (unsigned seed = 0; seed < 200; ++seed) {
    const SeededSet set = seeded_set(seed);
    SCOPED_TRACE(std::string(sphere_recipes()[set.recipe].name) + ", seed " + std::to_string(seed));
    expect_reference(spheres_of(set.spheres), seed % 2 == 0 ? 1.4 : 0.4);
  }
}

// Sets of one ball to some hundred, molecules and lattices: each is what it is alone.
TEST_P(ExcludedMeasurerContract, SetsOfABatchDoNotSeeEachOther) {
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets{0};
  std::vector<ExcludedTotals> alone;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const std::vector<Sphere> set = spheres_of(seeded_set(seed).spheres);
    atoms.insert(atoms.end(), set.begin(), set.end());
    offsets.push_back(atoms.size());
    alone.push_back(reference_of(set, 1.4).totals[0]);
  }
  const ExcludedBatch found = measure(atoms, 1.4, offsets);
  ASSERT_EQ(found.totals.size(), alone.size());
  for (std::size_t s = 0; s < alone.size(); ++s) {
    SCOPED_TRACE("set " + std::to_string(s));
    expect_same_totals(found.totals[s], alone[s]);
    double area = 0;
    for (std::size_t i = offsets[s]; i < offsets[s + 1]; ++i) {
      area += found.per_atom[i].area.sum();
    }
    EXPECT_NEAR(area, alone[s].area, kSameExcluded * alone[s].area);
  }
}

TEST_P(ExcludedMeasurerContract, GivesTheSameBitsAgain) {
  VDWMESH_NEEDS_SHARED("reference");
  const std::vector<Sphere> atoms = molecule("1CRN.xyzr");
  const ExcludedBatch a = measure(atoms, 1.4), b = measure(atoms, 1.4);
  EXPECT_EQ(a.totals[0].volume, b.totals[0].volume);
  EXPECT_EQ(a.totals[0].area, b.totals[0].area);
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    EXPECT_EQ(a.per_atom[i].volume, b.per_atom[i].volume);
    EXPECT_EQ(a.per_atom[i].area.concave, b.per_atom[i].area.concave);
  }
}

TEST_P(ExcludedMeasurerContract, RefusesWrongInput) {
  const std::vector<Sphere> ball{{{0, 0, 0}, 1}};
  for (const double probe : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(measure(ball, probe), InvalidInput);
  }
  EXPECT_THROW(measure({}, 1.4), InvalidInput);
  EXPECT_THROW(measure({{{0, 0, 0}, -1}}, 1.4), InvalidInput);
  EXPECT_THROW(measure(ball, 1.4, {0, 2}), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
