// Derivatives of many unions in one call, on every backend: references in quad precision, the
// regular triangulation beside, degenerate sets, batches, and the same bytes for any threads.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "measures/union_measurer.hpp"
#include "support/family_sets.hpp"
#include "support/shared_files.hpp"
#include "support/worst.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

using std::numbers::pi;
using EightNumbers = std::array<double, 8>;

EightNumbers numbers_of(const BallGradient& g) {
  return {g.area_center.x,   g.area_center.y,   g.area_center.z,   g.area_radius,
          g.volume_center.x, g.volume_center.y, g.volume_center.z, g.volume_radius};
}

// Largest difference of two derivatives, divided by 1 + the size of the second.
double difference(const BallGradient& found, const EightNumbers& expected) {
  const EightNumbers numbers = numbers_of(found);
  double most = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    most = worst(most, std::abs(numbers[k] - expected[k]) / (1 + std::abs(expected[k])));
  }
  return most;
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

// The weights of the references: 1/4 to 1 1/4, other for each of seven balls.
std::vector<double> reference_weights(std::size_t count) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(static_cast<double>(i % 7) / 7 + 0.25);
  return weights;
}

std::vector<double> any_weights(Dice& dice, std::size_t count) {
  std::vector<double> weights(count);
  for (double& w : weights) w = dice.one_in(5) ? 0 : dice.real(-2, 2);
  return weights;
}

// About as crowded as atoms in a protein.
std::vector<Sphere> crowd(Dice& dice, int count, double probe) {
  const double half = 0.5 * std::cbrt(20.0 * count);
  std::vector<Sphere> balls;
  for (int i = 0; i < count; ++i) {
    balls.push_back({random_point(dice, half), dice.real(1.2, 1.9) + probe});
  }
  return balls;
}

class UnionGradientsContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  BatchGradients gradients(const SphereBatch& batch, const BatchWeights& weights) const {
    BatchGradients result;
    make_union_measurer(GetParam())->gradients_into(result, batch, weights);
    return result;
  }
  BatchGradients gradients(const std::vector<Sphere>& balls, const std::vector<double>& area,
                           const std::vector<double>& volume) const {
    return gradients(
        {.spheres = balls.data(), .size = balls.size()},
        {area.empty() ? nullptr : area.data(), volume.empty() ? nullptr : volume.data()});
  }
};
VDWMESH_INSTANTIATE_BACKENDS(UnionGradientsContract);

// The bar of the references: 20 times what double loses with the formulas as they stand.
constexpr double kReferenceError = 1e-10;

// By set and probe: of each ball the plain derivatives, then the weighted ones.
using References =
    std::map<std::pair<std::string, double>, std::vector<std::array<EightNumbers, 2>>>;
References references() {
  References sets;
  std::ifstream file(shared_path("reference/gradients.csv"));
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    std::vector<std::string> f;
    while (std::getline(stream, cell, ',')) f.push_back(cell);
    auto& rows = sets[{f.at(0), std::stod(f.at(1))}];
    rows.emplace_back();
    for (std::size_t k = 0; k < 16; ++k) rows.back()[k / 8][k % 8] = std::stod(f.at(3 + k));
  }
  return sets;
}

TEST_P(UnionGradientsContract, References) {
  VDWMESH_NEEDS_SHARED("reference/gradients.csv");
  std::size_t rows = 0;
  for (const auto& [key, expected] : references()) {
    SCOPED_TRACE(key.first + " " + std::to_string(key.second));
    const SphereSet set = read_xyzr(shared_path("reference/" + key.first + ".xyzr"), key.second);
    const std::vector<Sphere> balls(set.spheres().begin(), set.spheres().end());
    const std::vector<double> w = reference_weights(balls.size());
    const BatchGradients plain = gradients(balls, {}, {}), weighted = gradients(balls, w, w);
    ASSERT_EQ(expected.size(), balls.size());
    double most = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      most = worst(most, difference(plain.per_sphere[i], expected[i][0]));
      most = worst(most, difference(weighted.per_sphere[i], expected[i][1]));
    }
    EXPECT_LE(most, kReferenceError);
    rows += balls.size();
  }
  constexpr std::size_t kRows = 2796;
  EXPECT_EQ(rows, kRows);
}

// dA/dd = 2 π (w₁ r₁ h₂ + w₂ r₂ h₁) / d and dV/dd = π ρ² along the axis.
TEST_P(UnionGradientsContract, TwoBallsInClosedForm) {
  const double r1 = 1.3, r2 = 0.9, d = 1.7;
  const std::vector<double> w{0.75, -1.5};
  const double h1 = (d * d + r1 * r1 - r2 * r2) / (2 * d), h2 = d - h1;
  const BallGradient g =
      gradients({{{0.2, 0.1, -0.3}, r1}, {{0.2, 0.1, -0.3 + d}, r2}}, w, {}).per_sphere[1];
  const double by_distance = 2 * pi * (w[0] * r1 * h2 + w[1] * r2 * h1) / d;
  // The area of a sphere of radius r less a cap of height r - h is 2 π r (r + h).
  const double dh1 = -r2 / d, dh2 = r2 / d;
  const double by_radius = w[0] * 2 * pi * r1 * dh1 + w[1] * 2 * pi * (2 * r2 + h2 + r2 * dh2);
  constexpr double kError = 1e-14;  // a dozen roundings of numbers below 10
  EXPECT_LE(difference(g, {0, 0, by_distance, by_radius, 0, 0, pi * (r1 * r1 - h1 * h1),
                           2 * pi * r2 * (r2 + h2)}),
            kError);
}

using KinksOfSets = std::vector<std::uint64_t>;

TEST_P(UnionGradientsContract, WhereThereIsNoDerivative) {
  const BatchGradients touching = gradients({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}}, {}, {});
  EXPECT_EQ(touching.kink_spheres, KinksOfSets{2});
  for (const BallGradient& g : touching.per_sphere) {
    EXPECT_LE(difference(g, {0, 0, 0, 8 * pi, 0, 0, 0, 4 * pi}), 1e-15);
  }
  const std::vector<double> w{1, 2, 100}, two{1, 2};
  const std::vector<Sphere> equal{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{1, 0, 0}, 1}};
  const BatchGradients of_equal = gradients(equal, w, w),
                       alone = gradients({equal[0], equal[1]}, two, two);
  EXPECT_EQ(of_equal.kink_spheres, KinksOfSets{1});
  EXPECT_EQ(numbers_of(of_equal.per_sphere[2]), EightNumbers{});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(numbers_of(of_equal.per_sphere[i]), numbers_of(alone.per_sphere[i]));
  }
  const BatchGradients swallowed =
      gradients({{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}, {{0, 1, 0}, 1}, {{0, 0, 0}, 1.5}}, {}, {});
  EXPECT_EQ(swallowed.kink_spheres, KinksOfSets{1});  // the third touches the first from inside
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(numbers_of(swallowed.per_sphere[i]), EightNumbers{});
  }
}

// Sums that are 0 in mathematics, beside the sum of sizes.
struct Balance {
  double sum = 0, size = 0;
  void add(double term) {
    sum += term;
    size += std::abs(term);
  }
};

// Translation and scaling: Σ ∂ = 0, Σ x·∂x + r ∂r = 2 A or 3 V.
TEST_P(UnionGradientsContract, IdentitiesOnSetsUnlikeProteins) {
  for_sets_of_families(300, [&](const std::vector<Sphere>& balls, Dice& dice, unsigned) {
    const std::vector<double> w = any_weights(dice, balls.size()),
                              u = any_weights(dice, balls.size());
    const BatchGradients g = gradients(balls, w, u);
    Balance area, volume, area_scale, volume_scale;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const BallGradient& d = g.per_sphere[i];
      const Vec3d x = balls[i].center - balls[0].center;
      for (int axis = 0; axis < 3; ++axis) {
        area.add(d.area_center[axis]);
        volume.add(d.volume_center[axis]);
        area_scale.add(x[axis] * d.area_center[axis]);
        volume_scale.add(x[axis] * d.volume_center[axis]);
      }
      area_scale.add(balls[i].radius * d.area_radius);
      volume_scale.add(balls[i].radius * d.volume_radius);
      area_scale.add(-2 * w[i] * g.measures.per_sphere[i].area);
      volume_scale.add(-3 * u[i] * g.measures.per_sphere[i].volume);
    }
    constexpr double kError = 1e-9;  // what terms of balls near a doubt may be wrong by
    for (const Balance& b : {area, volume, area_scale, volume_scale}) {
      EXPECT_LE(std::abs(b.sum), kError * (1 + b.size));
    }
  });
}

TEST_P(UnionGradientsContract, MeasuresHaveTheBitsOfTheMeasurer) {
  Dice dice(11);
  for (const double probe : {0.0, 1.4}) {
    const std::vector<Sphere> balls = crowd(dice, 800, probe);
    const BatchMeasures alone =
        make_union_measurer(GetParam())->measure({.spheres = balls.data(), .size = balls.size()});
    const BatchGradients g = gradients(balls, {}, {});
    EXPECT_TRUE(same_bytes(alone.per_sphere, g.measures.per_sphere));
    EXPECT_TRUE(same_bytes(alone.totals, g.measures.totals));
    EXPECT_EQ(alone.fallback_spheres, g.measures.fallback_spheres);
    for (std::size_t i = 0; i < balls.size(); ++i) {
      EXPECT_EQ(g.per_sphere[i].volume_radius, alone.per_sphere[i].area);
    }
  }
}

// A lattice, most of whose balls a device leaves to the triangulation, and sets beside it.
TEST_P(UnionGradientsContract, SetsOfABatchDoNotSeeEachOther) {
  Dice dice(4);
  std::vector<Sphere> lattice;
  for (int i = 0; i < 64; ++i) {
    lattice.push_back({{1.0 * (i % 4), 1.0 * (i / 4 % 4), 1.0 * (i / 16)}, 0.75});
  }
  const std::vector<std::vector<Sphere>> sets{crowd(dice, 90, 0), lattice, crowd(dice, 150, 1.4)};
  std::vector<Sphere> all;
  std::vector<std::size_t> offsets{0};
  for (const auto& set : sets) {
    all.insert(all.end(), set.begin(), set.end());
    offsets.push_back(all.size());
  }
  const std::vector<double> w = any_weights(dice, all.size()), u = any_weights(dice, all.size());
  const BatchGradients batch = gradients(
      {.spheres = all.data(), .size = all.size(), .offsets = offsets}, {w.data(), u.data()});
  if (GetParam() == Backend::cuda) {
    EXPECT_GT(batch.measures.fallback_spheres, 0u);
  }
  // A triangulation may be rounded otherwise beside other sets.
  constexpr double kOtherRounding = 1e-12;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const std::size_t first = offsets[s];
    BatchGradients alone = gradients({.spheres = sets[s].data(), .size = sets[s].size()},
                                     {w.data() + first, u.data() + first});
    for (std::size_t i = 0; i < sets[s].size(); ++i) {
      EXPECT_LE(difference(batch.per_sphere[first + i], numbers_of(alone.per_sphere[i])),
                kOtherRounding)
          << s << " " << i;
    }
  }
}

TEST_P(UnionGradientsContract, SameBytesForAnyNumberOfThreadsAndOrder) {
  Dice dice(7);
  const std::vector<Sphere> balls = crowd(dice, 4000, 1.4);
  const std::vector<double> w = any_weights(dice, balls.size());
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return gradients(balls, w, w);
  };
  const BatchGradients one = run(1);
  EXPECT_TRUE(same_bytes(one.per_sphere, run(2).per_sphere));
  EXPECT_TRUE(same_bytes(one.per_sphere, run(8).per_sphere));
  const std::vector<Sphere> turned(balls.rbegin(), balls.rend());
  const std::vector<double> turned_w(w.rbegin(), w.rend());
  const std::vector<BallGradient> back = gradients(turned, turned_w, turned_w).per_sphere;
  std::uint64_t differ = 0;
  for (std::size_t i = 0; i < balls.size(); ++i) {
    differ += numbers_of(one.per_sphere[i]) != numbers_of(back[balls.size() - 1 - i]);
  }
  EXPECT_LE(differ, one.measures.fallback_spheres);  // only those that a triangulation measured
}

TEST_P(UnionGradientsContract, RefusesWhatIsNoWeight) {
  const std::vector<Sphere> two{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}};
  EXPECT_THROW(gradients(two, {1, std::numeric_limits<double>::quiet_NaN()}, {}), InvalidInput);
  EXPECT_THROW(gradients(SphereBatch{}, {}), InvalidInput);
}

// Both backends, ball by ball. Balls that one of them leaves to the triangulation may differ more.
TEST(UnionGradientsOnBothBackends, DifferByRounding) {
  if (const std::string missing = missing_backend(Backend::cuda); !missing.empty()) {
    VDWMESH_MISSING("VDWMESH_REQUIRE_CUDA", missing);
  }
  const auto compare = [](const std::vector<Sphere>& balls, Dice& dice, double bound) {
    const std::vector<double> w = any_weights(dice, balls.size()),
                              u = any_weights(dice, balls.size());
    const SphereBatch batch{.spheres = balls.data(), .size = balls.size()};
    BatchGradients cpu, cuda;
    make_union_measurer(Backend::cpu)->gradients_into(cpu, batch, {w.data(), u.data()});
    make_union_measurer(Backend::cuda)->gradients_into(cuda, batch, {w.data(), u.data()});
    double most = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      most = worst(most, difference(cuda.per_sphere[i], numbers_of(cpu.per_sphere[i])));
    }
    EXPECT_LE(most, bound);
  };
  constexpr double kRounding = 1e-11, kNearlyDegenerate = 1e-8;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    Dice dice(seed);
    for (const double probe : {0.0, 1.4}) compare(crowd(dice, 2000, probe), dice, kRounding);
  }
  for_sets_of_families(300, [&](const std::vector<Sphere>& balls, Dice& dice, unsigned) {
    compare(balls, dice, kNearlyDegenerate);
  });
}

}  // namespace
}  // namespace vdwmesh::testing
