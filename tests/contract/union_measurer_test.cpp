// Measures of many unions in one call, on every backend: closed forms, the regular triangulation as
// the reference, batches, determinism, and input that must be refused.
#include "measures/union_measurer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "measures/exact_union.hpp"
#include "support/dice.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// Share of the whole sphere's area, and of the ball's volume, by which two computations of a ball
// in general position may differ. Some fifty operations for each of a hundred corners, each wrong
// by 1.1e-16, are 6e-13.
constexpr double kRounding = 1e-12;
// The same for nearly degenerate balls, whose corners are ill-conditioned; the arcs accept angles
// that are good to 1e-9.
constexpr double kNearlyDegenerate = 1e-9;

class UnionMeasurerContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  BatchMeasures measure(const SphereBatch& batch) const {
    return make_union_measurer(GetParam())->measure(batch);
  }
  BatchMeasures measure(const std::vector<Sphere>& spheres) const {
    return measure({.spheres = spheres.data(), .size = spheres.size()});
  }
  BatchMeasures measure(const SphereSet& spheres) const { return measure(batch_of(spheres)); }
};
VDWMESH_INSTANTIATE_BACKENDS(UnionMeasurerContract);

double sphere_area(double r) { return 4 * kPi * r * r; }
double ball_volume(double r) { return 4 * kPi / 3 * r * r * r; }

// Compares with the measures of the triangulation, ball by ball and in total.
void expect_reference(const SphereSet& spheres, const BatchMeasures& measured, double tolerance) {
  const ExactUnion reference = exact_union(spheres, {.method = UnionMethod::cgal});
  ASSERT_EQ(measured.per_sphere.size(), spheres.size());
  double area = 0, volume = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double r = spheres[i].radius;
    area += sphere_area(r);
    volume += ball_volume(r);
    const SphereMeasures& m = measured.per_sphere[i];
    const SphereMeasures& e = reference.per_sphere[i];
    EXPECT_TRUE(std::abs(m.area - e.area) <= tolerance * sphere_area(r))
        << "sphere " << i << ": " << m.area - e.area << " of " << e.area;
    EXPECT_TRUE(std::abs(m.volume - e.volume) <= tolerance * ball_volume(r))
        << "sphere " << i << ": " << m.volume - e.volume << " of " << e.volume;
  }
  ASSERT_EQ(measured.totals.size(), 1u);
  EXPECT_TRUE(std::abs(measured.totals[0].area - reference.area) <= tolerance * area);
  EXPECT_TRUE(std::abs(measured.totals[0].volume - reference.volume) <= tolerance * volume);
}

std::vector<Sphere> grown(const SphereSet& spheres, double probe) {
  std::vector<Sphere> result(spheres.spheres().begin(), spheres.spheres().end());
  for (Sphere& s : result) s.radius += probe;
  return result;
}

// Random balls, about as crowded as atoms in a protein.
std::vector<Sphere> crowd(unsigned seed, int count, double probe) {
  Dice dice(seed);
  const double half = 0.5 * std::cbrt(20.0 * count);
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double x = dice.real(-half, half), y = dice.real(-half, half);
    spheres.push_back({{x, y, dice.real(-half, half)}, dice.real(1.2, 1.9) + probe});
  }
  return spheres;
}

bool same_bits(const std::vector<SphereMeasures>& a, const std::vector<SphereMeasures>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

TEST_P(UnionMeasurerContract, OneBall) {
  const BatchMeasures m = measure(std::vector<Sphere>{{{1, 2, 3}, 2}});
  EXPECT_NEAR(m.per_sphere[0].area, sphere_area(2), kRounding * sphere_area(2));
  EXPECT_NEAR(m.totals[0].volume, ball_volume(2), kRounding * ball_volume(2));
  EXPECT_EQ(m.fallback_spheres, 0u);
}

// Each of two equal balls loses a cap of height h = r - d / 2: area 2 π r h, volume
// π h² (3 r - h) / 3.
TEST_P(UnionMeasurerContract, TwoBalls) {
  const double r = 1.5, d = 2, h = r - d / 2;
  const BatchMeasures m = measure(std::vector<Sphere>{{{0.1, 0.2, 0}, r}, {{0.1, 0.2, d}, r}});
  for (const SphereMeasures& ball : m.per_sphere) {
    EXPECT_NEAR(ball.area, sphere_area(r) - 2 * kPi * r * h, kRounding * sphere_area(r));
    EXPECT_NEAR(ball.volume, ball_volume(r) - kPi * h * h * (3 * r - h) / 3,
                kRounding * ball_volume(r));
  }
  EXPECT_EQ(m.fallback_spheres, 0u);
}

TEST_P(UnionMeasurerContract, OfEqualBallsTheFirstOwnsAll) {
  const std::vector<Sphere> spheres(5, Sphere{{1, 1, 1}, 1});
  const BatchMeasures m = measure(spheres);
  EXPECT_NEAR(m.per_sphere[0].area, sphere_area(1), kRounding * sphere_area(1));
  for (std::size_t i = 1; i < spheres.size(); ++i) {
    EXPECT_EQ(m.per_sphere[i].area, 0);
    EXPECT_EQ(m.per_sphere[i].volume, 0);
  }
}

TEST_P(UnionMeasurerContract, NestedAndTangentBalls) {
  const BatchMeasures m = measure(std::vector<Sphere>{
      {{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 4, 0}, 2}, {{0, 0, -3}, 1}});
  for (const std::size_t i : {0u, 3u, 4u}) {
    const double r = i == 4 ? 1 : 2;
    EXPECT_NEAR(m.per_sphere[i].area, sphere_area(r), kNearlyDegenerate * sphere_area(r));
    EXPECT_NEAR(m.per_sphere[i].volume, ball_volume(r), kNearlyDegenerate * ball_volume(r));
  }
  EXPECT_EQ(m.per_sphere[1].area, 0);
  EXPECT_NEAR(m.per_sphere[2].area, 0, kNearlyDegenerate);
  EXPECT_NEAR(m.per_sphere[2].volume, 0, kNearlyDegenerate);
}

TEST_P(UnionMeasurerContract, CrowdsAgreeWithTheTriangulation) {
  for (const double probe : {0.0, 1.4}) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", probe " << probe);
      const SphereSet spheres(crowd(seed, 400, probe));
      const BatchMeasures m = measure(spheres);
      expect_reference(spheres, m, kRounding);
      EXPECT_LE(m.fallback_spheres, 4u);
    }
  }
}

TEST_P(UnionMeasurerContract, SeededSetsAgreeWithTheTriangulation) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const SeededSet set = seeded_set(seed);
    const SphereRecipe& recipe = sphere_recipes()[set.recipe];
    SCOPED_TRACE(::testing::Message() << recipe.name << ", seed " << seed);
    for (const double probe : {0.0, 1.4}) {
      const SphereSet spheres(grown(set.spheres, probe));
      expect_reference(spheres, measure(spheres), kNearlyDegenerate);
    }
  }
}

// Up to 26 neighbours whose planes meet by many in the same points.
TEST_P(UnionMeasurerContract, LatticesAgreeWithTheTriangulation) {
  for (const double radius : {0.4, 0.5, 0.6, std::sqrt(0.5), std::sqrt(0.75), 1.0, 1.7}) {
    SCOPED_TRACE(radius);
    std::vector<Sphere> spheres;
    for (int i = 0; i < 5 * 5 * 5; ++i) {
      spheres.push_back({{1.0 * (i % 5), 1.0 * (i / 5 % 5), 1.0 * (i / 25)}, radius});
    }
    const SphereSet set(std::move(spheres));
    expect_reference(set, measure(set), kNearlyDegenerate);
  }
}

TEST_P(UnionMeasurerContract, MoleculesAgreeWithTheTriangulation) {
  for (const char* name : {"1CRN", "1UBQ", "4HHB"}) {
    const std::string file = std::string("reference/") + name + ".xyzr";
    VDWMESH_NEEDS_SHARED(file);
    for (const double probe : {0.0, 1.4}) {
      SCOPED_TRACE(::testing::Message() << name << ", probe " << probe);
      const SphereSet spheres = read_xyzr(shared_path(file), probe);
      expect_reference(spheres, measure(spheres), kRounding);
    }
  }
}

// A ball with more neighbours than any room for one ball has, and with 600, of which many are left.
TEST_P(UnionMeasurerContract, ManyNeighbors) {
  for (const int count : {100, 600, 3000}) {
    SCOPED_TRACE(count);
    Dice dice(static_cast<unsigned>(count));
    std::vector<Sphere> spheres{{{0, 0, 0}, 10}};
    while (spheres.size() <= static_cast<std::size_t>(count)) {
      const double x = dice.real(-1, 1), y = dice.real(-1, 1), z = dice.real(-1, 1);
      const double length = std::sqrt(x * x + y * y + z * z);
      if (length < 0.1 || length > 1) continue;
      const double scale = 10 / length;
      spheres.push_back({{scale * x, scale * y, scale * z}, dice.real(0.1, 0.4)});
    }
    const SphereSet set(std::move(spheres));
    expect_reference(set, measure(set), kRounding);
  }
}

// Radii over six orders of magnitude.
TEST_P(UnionMeasurerContract, GiantsAmongDust) {
  Dice dice(3);
  std::vector<Sphere> spheres{{{0, 0, 0}, 100}};
  for (int i = 0; i < 500; ++i) {
    const double radius = std::pow(10.0, dice.real(-4, 1));
    const double angle = dice.real(0, 2 * kPi);
    spheres.push_back({{100 * std::cos(angle), 100 * std::sin(angle), dice.real(-1, 1)}, radius});
  }
  const SphereSet set(std::move(spheres));
  expect_reference(set, measure(set), kNearlyDegenerate);
}

TEST_P(UnionMeasurerContract, SetsOfABatchDoNotSeeEachOther) {
  std::vector<Sphere> all;
  std::vector<std::size_t> offsets{0};
  std::vector<std::vector<Sphere>> sets;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    sets.push_back(crowd(seed, 1 + static_cast<int>(seed * seed % 90), seed % 2 == 0 ? 1.4 : 0));
    all.insert(all.end(), sets.back().begin(), sets.back().end());
    offsets.push_back(all.size());
  }
  const BatchMeasures m = measure({.spheres = all.data(), .size = all.size(), .offsets = offsets});
  ASSERT_EQ(m.totals.size(), sets.size());
  for (std::size_t i = 0; i < sets.size(); ++i) {
    SCOPED_TRACE(i);
    const BatchMeasures alone = measure(sets[i]);
    const auto first = m.per_sphere.begin() + static_cast<std::ptrdiff_t>(offsets[i]);
    EXPECT_TRUE(
        same_bits(alone.per_sphere, {first, first + static_cast<std::ptrdiff_t>(sets[i].size())}));
    EXPECT_TRUE(same_bits(alone.totals, {m.totals[i]}));
  }
}

TEST_P(UnionMeasurerContract, GivesTheSameBitsAgain) {
  const SphereSet spheres(crowd(5, 3000, 1.4));
  const BatchMeasures first = measure(spheres);
  BatchMeasures again = measure(batch_of(SphereSet(crowd(6, 20, 0))));
  make_union_measurer(GetParam())->measure_into(again, batch_of(spheres));
  EXPECT_TRUE(same_bits(first.per_sphere, again.per_sphere));
  EXPECT_TRUE(same_bits(first.totals, again.totals));
}

TEST_P(UnionMeasurerContract, RefusesWhatIsNoBatch) {
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 1}};
  EXPECT_THROW(measure(SphereBatch{}), InvalidInput);
  for (const std::vector<std::size_t>& offsets : std::vector<std::vector<std::size_t>>{
           {0}, {0, 2}, {1, 3}, {0, 4}, {0, 2, 1, 3}, {0, 1, 1, 3}, {0, 3, 3}}) {
    EXPECT_THROW(measure({.spheres = spheres.data(), .size = 3, .offsets = offsets}), InvalidInput);
  }
}

TEST_P(UnionMeasurerContract, RefusesWhatIsNoSphere) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Sphere& bad : {Sphere{{0, 0, 0}, 0}, Sphere{{0, 0, 0}, -1}, Sphere{{0, 0, 0}, kNan},
                            Sphere{{0, kNan, 0}, 1}, Sphere{{0, 0, 2e30}, 1}}) {
    const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, bad};
    EXPECT_THROW(measure(spheres), InvalidInput);
  }
}

TEST_P(UnionMeasurerContract, NamesABadSphereByItsPlaceInTheBatch) {
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, -1}};
  const std::vector<std::size_t> offsets{0, 1, 2, 3};
  try {
    measure({.spheres = spheres.data(), .size = 3, .offsets = offsets});
    FAIL() << "a negative radius was accepted";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string_view(error.what()).find("sphere 2:"), std::string_view::npos)
        << error.what();
  }
}

TEST(UnionMeasurerOnTheCpu, RefusesSpheresInDeviceMemory) {
  const Sphere sphere{{0, 0, 0}, 1};
  EXPECT_THROW(make_cpu_union_measurer()->measure(
                   {.spheres = &sphere, .size = 1, .memory = MemorySpace::device}),
               InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
