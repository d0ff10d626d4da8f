// Certificates of whole unions: against an evaluation with 60 digits, closed forms and the
// published table, and the same bits for any order and number of threads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/errors.hpp"
#include "support/certificate_sets.hpp"
#include "union_reference_sets.hpp"

namespace vdwmesh {
namespace {

using testing::kCertifiedWidth;

UnionCertificate certified(std::vector<Sphere> spheres, UnionOptions options = {}) {
  options.certify = true;
  return exact_union(SphereSet(std::move(spheres)), options).certificate.value();
}

bool same_bits(const Enclosure& a, const Enclosure& b) {
  return a.lower == b.lower && a.upper == b.upper;
}
bool same_bits(const UnionCertificate& a, const UnionCertificate& b) {
  return same_bits(a.area, b.area) && same_bits(a.volume, b.volume) &&
         a.wide_spheres == b.wide_spheres && a.bits == b.bits;
}

TEST(Certificate, ContainsTheValueWithSixtyDigits) {
  constexpr std::size_t kMostBalls = 14;  // the oracle's time grows with the cube
  int sets = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const SphereSet spheres = testing::certificate_set(seed);
    if (spheres.size() > kMostBalls) continue;
    ++sets;
    const UnionCertificate c = testing::certificate_of(spheres);
    const auto truth = testing::true_measures(spheres);
    EXPECT_TRUE(testing::contains(c.area, truth.area)) << seed;
    EXPECT_TRUE(testing::contains(c.volume, truth.volume)) << seed;
    EXPECT_LE(testing::relative_width(c.area), kCertifiedWidth) << seed;
    EXPECT_LE(testing::relative_width(c.volume), kCertifiedWidth) << seed;
  }
  EXPECT_GE(sets, 100);
}

TEST(Certificate, ContainsThePublishedValues) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  constexpr std::size_t kRows = 48;  // 24 sets with two probes
  for (const auto& row :
       testing::wanted_rows(kRows, [](const std::string& set) { return set != "6ZU5"; })) {
    testing::expect_certified_row(row);
  }
}

TEST(Certificate, OneBallIsKnownToTheLastDigits) {
  const UnionCertificate c = certified({{{1, 2, 3}, 2}});
  const reference::Digits pi = acos(reference::Digits(-1));
  EXPECT_TRUE(testing::contains(c.area, reference::Digits(16 * pi)));
  EXPECT_TRUE(testing::contains(c.volume, reference::Digits(32 * pi / 3)));
  constexpr double kUnits = 4 * 0x1p-52;  // four in the last place
  EXPECT_LE(testing::relative_width(c.area), kUnits);
  EXPECT_LE(testing::relative_width(c.volume), kUnits);
  EXPECT_EQ(c.wide_spheres, 0u);
  EXPECT_EQ(c.bits, 53);
}

// A triangle with a height of 2^-40, of balls with common points: doubles lose twelve digits.
TEST(Certificate, FlatTrianglesTakeMoreThanDouble) {
  const std::vector<Sphere> flat{
      {{0, 0, 0}, 1}, {{0.5, 0x1p-40, 0}, std::sqrt(0.75)}, {{1, 0, 0}, 1}};
  const UnionCertificate c = certified(flat);
  EXPECT_EQ(c.wide_spheres, 3u);
  EXPECT_GT(c.bits, 53);
  EXPECT_TRUE(testing::contains(c, testing::true_measures(SphereSet(flat))));
  EXPECT_LE(testing::relative_width(c.area), kCertifiedWidth);
}

// A ball in another one is left out of the sums, and of concentric ones all but one.
TEST(Certificate, NestedBallsAddNothing) {
  const UnionCertificate one = certified({{{0, 0, 0}, 1.5}});
  EXPECT_TRUE(same_bits(
      one, certified({{{0, 0, 0}, 1.5}, {{0, 0, 0}, 1}, {{0, 0, 0}, 1.5}, {{0.5, 0, 0}, 0.25}})));
  // It touches the large one from inside.
  EXPECT_TRUE(testing::contains(certified({{{0, 0, 0}, 1.5}, {{1, 0, 0}, 0.5}}),
                                testing::true_measures(SphereSet({{{0, 0, 0}, 1.5}}))));
}

TEST(Certificate, DoesNotDependOnOrderOrThreads) {
  for (const unsigned seed : {2u, 5u, 10u, 13u, 22u, 31u}) {
    const SphereSet spheres = testing::certificate_set(seed);
    const UnionCertificate first = testing::certificate_of(spheres);
    std::vector<Sphere> shuffled(spheres.spheres().begin(), spheres.spheres().end());
    std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937_64(seed));
    EXPECT_TRUE(same_bits(first, testing::certificate_of(SphereSet(std::move(shuffled))))) << seed;
  }
  // Large enough for several tasks.
  std::mt19937_64 random(7);
  const SphereSet many(testing::jittered(testing::cubic_lattice(10, 1.2, 1), 0.2, random));
  const UnionCertificate on_all = testing::certificate_of(many);
  for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_TRUE(same_bits(on_all, testing::certificate_of(many))) << threads;
  }
}

TEST(Certificate, EveryMethodHasTheSame) {
  std::mt19937_64 random(3);
  const auto balls = testing::jittered(testing::cubic_lattice(4, 1.2, 1), 0.2, random);
  UnionOptions options;
  options.method = UnionMethod::cgal;
  const UnionCertificate expected = certified(balls, options);
  for (const auto method : {UnionMethod::automatic, UnionMethod::arcs, UnionMethod::both}) {
    options.method = method;
    EXPECT_TRUE(same_bits(expected, certified(balls, options)));
  }
  options.certify = false;
  EXPECT_FALSE(exact_union(SphereSet(balls), options).certificate);
}

// Two balls in the presence of both: the halves of a symmetric pair, which the oracle has whole.
TEST(Certificate, CoversTheMeasuredSpheresOnly) {
  const std::vector<Sphere> pair{{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}};
  const std::vector<SphereId> second{1}, both{0, 1};
  UnionOptions options;
  options.measured = second;
  const UnionCertificate half = certified(pair, options);
  const auto whole = testing::true_measures(SphereSet(pair));
  EXPECT_TRUE(testing::contains(half.area, reference::Digits(whole.area / 2)));
  EXPECT_TRUE(testing::contains(half.volume, reference::Digits(whole.volume / 2)));
  options.measured = both;
  EXPECT_TRUE(same_bits(certified(pair), certified(pair, options)));
}

// Each ball of a heap by itself: the parts add up to the whole.
TEST(Certificate, PartsAddUpToTheWhole) {
  std::mt19937_64 random(11);
  const auto balls = testing::jittered(testing::cubic_lattice(3, 1.1, 1), 0.3, random);
  const UnionCertificate whole = certified(balls);
  Enclosure area{0, 0}, volume{0, 0};
  for (SphereId id = 0; id < balls.size(); ++id) {
    UnionOptions options;
    const std::vector<SphereId> one{id};
    options.measured = one;
    const UnionCertificate part = certified(balls, options);
    area = {area.lower + part.area.lower, area.upper + part.area.upper};
    volume = {volume.lower + part.volume.lower, volume.upper + part.volume.upper};
  }
  constexpr double kPlainSums = 1e-12;  // Å², Å³: of 27 terms below 100
  EXPECT_LE(area.lower - kPlainSums, whole.area.upper);
  EXPECT_GE(area.upper + kPlainSums, whole.area.lower);
  EXPECT_LE(volume.lower - kPlainSums, whole.volume.upper);
  EXPECT_GE(volume.upper + kPlainSums, whole.volume.lower);
  EXPECT_LE(area.upper - area.lower, 1e-10);
  EXPECT_LE(volume.upper - volume.lower, 1e-10);
}

// Sizes in other units: powers of two change nothing but the exponent, exactly.
TEST(Certificate, ScalesWithItsInput) {
  const std::vector<Sphere> pair{{{0, 0, 0}, 1}, {{1.25, 0.5, 0}, 0.75}};
  const UnionCertificate plain = certified(pair);
  for (const double unit : {0x1p-80, 0x1p80}) {
    std::vector<Sphere> scaled = pair;
    for (Sphere& s : scaled) s = {unit * s.center, unit * s.radius};
    const UnionCertificate c = certified(scaled);
    EXPECT_EQ(c.area.lower, plain.area.lower * unit * unit);
    EXPECT_EQ(c.volume.upper, plain.volume.upper * unit * unit * unit);
  }
}

// 2^-1074 is the least double; next to a radius of 2^10 scaling loses it.
TEST(Certificate, RefusesWhatScalingWouldChange) {
  UnionOptions options;
  options.certify = true;
  EXPECT_THROW(exact_union(SphereSet({{{0x1p-1074, 0, 0}, 0x1p10}}), options), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
