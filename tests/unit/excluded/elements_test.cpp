// The steps that a CUDA device executes, executed on the host, against excluded_measures(): the two
// share closed forms, but no arrangement. Here are all molecules and sets of the table, and random
// sets unlike them; tests/contract/excluded_measurer_test.cpp has the device itself.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "excluded/elements/batch_rows.hpp"
#include "measures/union_measurer.hpp"
#include "support/excluded_batches.hpp"
#include "support/host_executor.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

using namespace excluded::elements;

// An executor that finds every circle, corner and patch doubtful, so that the host decides all.
class DoubtfulExecutor : public HostExecutor {
 public:
  template <class Step>
  void run(const char* name, std::uint64_t count, const Step& step) const {
    HostExecutor::run(name, count, step);
    for (std::uint64_t i = 0; i < count; ++i) {
      if constexpr (std::is_same_v<Step, CountArcs> || std::is_same_v<Step, MeasureLow>) {
        step.doubtful[i] = 1;
      }
      if constexpr (std::is_same_v<Step, MarkCorners>) step.wide[i] = 1;
    }
  }
  OverlapLists<DoubtfulExecutor> overlaps(const std::vector<Sphere>& balls,
                                          const std::vector<std::uint32_t>& set,
                                          std::size_t sets) const {
    auto [first, other, owner, entries] = HostExecutor::overlaps(balls, set, sets);
    return {std::move(first), std::move(other), std::move(owner), entries};
  }
};

// An executor that finds as many pairs of overlapping balls as 32 bits number, and one more.
class CrowdedExecutor : public HostExecutor {
 public:
  OverlapLists<CrowdedExecutor> overlaps(const std::vector<Sphere>& balls,
                                         const std::vector<std::uint32_t>& set,
                                         std::size_t sets) const {
    auto [first, other, owner, entries] = HostExecutor::overlaps(balls, set, sets);
    return {std::move(first), std::move(other), std::move(owner), std::uint64_t{1} << 32};
  }
};

// What a device does with the spheres of a batch.
template <class Executor = HostExecutor>
ExcludedBatch by_elements(const std::vector<Sphere>& atoms, const std::vector<std::size_t>& offsets,
                          double probe) {
  const SphereBatch batch{.spheres = atoms.data(), .size = atoms.size(), .offsets = offsets};
  std::vector<Sphere> grown = atoms;
  for (Sphere& s : grown) s.radius += probe;
  const BatchMeasures unions = make_cpu_union_measurer()->measure(
      {.spheres = grown.data(), .size = grown.size(), .offsets = offsets});
  std::vector<double> radius;
  std::vector<std::uint32_t> set;
  std::vector<Vec3d> home;
  for (std::size_t s = 0; s < batch.set_count(); ++s) {
    home.push_back(atoms[batch.set_begin(s)].center);
    for (std::size_t i = batch.set_begin(s); i < batch.set_end(s); ++i) {
      set.push_back(static_cast<std::uint32_t>(s));
      radius.push_back(atoms[i].radius);
    }
  }
  const Balls balls{grown.data(), radius.data(), unions.per_sphere.data(),
                    nullptr,      set.data(),    static_cast<std::uint32_t>(atoms.size()),
                    probe};
  Executor executor;
  const auto near = executor.overlaps(grown, set, batch.set_count());
  ExcludedBatch result;
  const std::vector<std::size_t> ends = offsets_of(batch);
  const ElementSums sums =
      ElementPipeline<Executor>(executor, balls, near, ends, home).run(rows_of(result, batch));
  sum_sets(result, batch, probe, sums, unions.totals, nullptr);
  return result;
}

ExcludedBatch expected_of(const std::vector<Sphere>& atoms, const std::vector<std::size_t>& offsets,
                          double probe) {
  return make_cpu_excluded_measurer()->measure(
      {.spheres = atoms.data(), .size = atoms.size(), .offsets = offsets}, probe);
}

class ElementsOf : public ::testing::TestWithParam<const char*> {};

TEST_P(ElementsOf, AreThoseOfTheDualComplex) {
  VDWMESH_NEEDS_SHARED("reference");
  const std::vector<Sphere> atoms =
      spheres_of(read_xyzr(shared_path("reference/" + std::string(GetParam()) + ".xyzr")));
  for (const double probe : {0.7, 1.4, 3.0}) {
    SCOPED_TRACE(probe);
    const ExcludedBatch found = by_elements(atoms, {}, probe),
                        expected = expected_of(atoms, {}, probe);
    expect_same(found, expected);
    expect_little_help(found, expected);
  }
}
INSTANTIATE_TEST_SUITE_P(Table, ElementsOf,
                         ::testing::Values("2spheres", "3spheres", "cube", "benzene", "1L2Y",
                                           "1CRN", "110D", "1UBQ", "4PTI", "1EJG"),
                         [](const auto& set) { return "Of" + std::string(set.param); });

TEST(Elements, OfRandomSetsAreThoseOfTheDualComplex) {
  std::uint64_t on_host = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    const SeededSet set = seeded_set(seed);
    const std::vector<Sphere> atoms = spheres_of(set.spheres);
    for (const double probe : {1.4, 0.4}) {
      SCOPED_TRACE(std::string(sphere_recipes()[set.recipe].name) + ", seed " +
                   std::to_string(seed) + ", probe " + std::to_string(probe));
      const ExcludedBatch found = by_elements(atoms, {}, probe);
      expect_same(found, expected_of(atoms, {}, probe));
      on_host += found.host_sets;
    }
  }
  // Lattices, rings and twins have probes that touch four atoms; nine sets of ten have none.
  EXPECT_LT(on_host, 60u);
}

// What the host decides element by element is the same surface.
TEST(Elements, MayAllBeDecidedOnTheHost) {
  VDWMESH_NEEDS_SHARED("reference");
  const std::vector<Sphere> atoms = spheres_of(read_xyzr(shared_path("reference/1L2Y.xyzr")));
  for (const double probe : {0.7, 1.4}) {
    const ExcludedBatch found = by_elements<DoubtfulExecutor>(atoms, {}, probe);
    EXPECT_EQ(found.host_sets, 0u);
    EXPECT_GT(found.host_circles, 300u);
    EXPECT_EQ(found.host_corners, found.totals[0].counts.probes);
    EXPECT_EQ(found.host_patches, found.totals[0].counts.low_probes);
    expect_same(found, expected_of(atoms, {}, probe));
  }
}

// A set whose probes touch four atoms, between two others that have none.
TEST(Elements, OfSeveralSetsAreThoseOfEach) {
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets{0};
  for (const unsigned seed : {1u, 2u, 3u, 14u, 5u}) {
    const std::vector<Sphere> set = spheres_of(seeded_set(seed).spheres);
    atoms.insert(atoms.end(), set.begin(), set.end());
    offsets.push_back(atoms.size());
  }
  for (int i = 0; i < 4; ++i) atoms.push_back({{3.0 * (i % 2), 3.0 * (i / 2), 0}, 1.5});
  offsets.push_back(atoms.size());
  atoms.push_back({{0, 0, 0}, 1});
  offsets.push_back(atoms.size());
  const ExcludedBatch found = by_elements(atoms, offsets, 1.4);
  EXPECT_GE(found.host_sets, 1u);
  EXPECT_LT(found.host_sets, offsets.size() - 1);
  expect_same(found, expected_of(atoms, offsets, 1.4));
}

// The patches that the host decided are told of the set that has them.
TEST(Elements, TellsTheHostsPatchesOfEachSet) {
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets{0};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const std::vector<Sphere> set = spheres_of(seeded_set(seed).spheres);
    atoms.insert(atoms.end(), set.begin(), set.end());
    offsets.push_back(atoms.size());
  }
  const ExcludedBatch found = by_elements<DoubtfulExecutor>(atoms, offsets, 1.4);
  std::uint64_t sum = 0;
  for (std::size_t s = 0; s + 1 < offsets.size(); ++s) {
    const ExcludedSurface one = surface_of(found, s);
    sum += one.checks.extended_decisions;
    EXPECT_EQ(one.checks.extended_decisions, found.totals[s].extended_decisions);
    EXPECT_LE(one.checks.extended_decisions, one.counts.low_probes);
  }
  EXPECT_GT(sum, 0u);
  EXPECT_EQ(sum, found.host_patches);
}

// A circle and a patch are decided from the balls of their own set, wherever it is in the batch.
TEST(Elements, AreDecidedFromTheirOwnSet) {
  const std::vector<Sphere> set = spheres_of(seeded_set(3).spheres);
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets{0};
  for (int i = 0; i < 5; ++i) {
    for (Sphere s : set) {
      s.radius += i == 2 ? 0 : 0.1 * i;
      atoms.push_back(s);
    }
    offsets.push_back(atoms.size());
  }
  expect_same(by_elements<DoubtfulExecutor>(atoms, offsets, 1.4), expected_of(atoms, offsets, 1.4));
}

// The numbers of pairs have 32 bits: a batch with more is refused, before anything is made of them.
TEST(Elements, OfMorePairsThanAreNumberedAreRefused) {
  const std::vector<Sphere> atoms{{{0, 0, 0}, 1.5}, {{2, 0, 0}, 1.5}};
  try {
    by_elements<CrowdedExecutor>(atoms, {}, 1.4);
    FAIL() << "was measured";
  } catch (const DeviceMemoryExceeded& error) {
    EXPECT_EQ(std::string(error.what()).find("4294967296 pairs of overlapping balls"), 0u)
        << error.what();
  }
}

// Three atoms whose probes touch the plane of their centres, one on each side of it and in the
// other one. Low probes of other sets lie at nearly the same places, and cut nothing of these.
TEST(Elements, LowProbesAreCutByThoseOfTheirOwnSet) {
  std::vector<Sphere> atoms;
  std::vector<std::size_t> offsets{0};
  const double sides[] = {4.7, 4.6, 4.8, 4.65};  // Å; a probe of 1.4 Å is low from 4.4 to 5.02 Å
  for (const double side : sides) {
    for (int i = 0; i < 3; ++i) {
      const double turn = 2 * std::numbers::pi * i / 3, radius = side / std::numbers::sqrt3;
      atoms.push_back({{radius * std::cos(turn), radius * std::sin(turn), 0.1 * side}, 1.5});
    }
    offsets.push_back(atoms.size());
  }
  const ExcludedBatch found = by_elements(atoms, offsets, 1.4);
  for (const auto& totals : found.totals) EXPECT_EQ(totals.counts.low_probes, 2u);
  EXPECT_EQ(found.host_sets, 0u);
  EXPECT_EQ(found.host_patches, 0u);
  expect_same(found, expected_of(atoms, offsets, 1.4));
}

}  // namespace
}  // namespace vdwmesh::testing
