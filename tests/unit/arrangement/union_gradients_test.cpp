// Derivatives of area and volume against references in quad precision, closed forms and identities.
#include "measures/union_gradients.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>
#include <sstream>
#include <utility>

#include "core/errors.hpp"
#include "measures/complex_faces.hpp"
#include "support/family_sets.hpp"
#include "support/gradient_identities.hpp"
#include "support/shared_files.hpp"
#include "support/worst.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh {
namespace {

using std::numbers::pi;
using testing::Balance;

using EightNumbers = std::array<double, 8>;

EightNumbers numbers_of(const BallGradient& g) {
  return {g.area_center.x,   g.area_center.y,   g.area_center.z,   g.area_radius,
          g.volume_center.x, g.volume_center.y, g.volume_center.z, g.volume_radius};
}

bool same_bytes(const std::vector<BallGradient>& a, const std::vector<BallGradient>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
}

// 1/4 to 1 1/4, other for each of seven balls: the weights of the references.
std::vector<double> weights_of(std::size_t count) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < count; ++i) weights.push_back(static_cast<double>(i % 7) / 7 + 0.25);
  return weights;
}

std::vector<double> any_weights(testing::Dice& dice, std::size_t count) {
  std::vector<double> weights(count);
  for (double& w : weights) w = dice.one_in(5) ? 0 : dice.real(-2, 2);
  return weights;
}

UnionGradients with_weights(const std::vector<Sphere>& balls, const std::vector<double>& area,
                            const std::vector<double>& volume) {
  return union_gradients(SphereSet(balls), {.area_weights = area, .volume_weights = volume});
}

struct ReferenceGradients {
  std::vector<EightNumbers> plain, weighted;
};

// By set and probe; rows are in the order of the balls.
std::map<std::pair<std::string, double>, ReferenceGradients> reference_gradients() {
  std::map<std::pair<std::string, double>, ReferenceGradients> sets;
  std::ifstream file(testing::shared_path("reference/gradients.csv"));
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    std::vector<std::string> f;
    while (std::getline(stream, cell, ',')) f.push_back(cell);
    ReferenceGradients& set = sets[{f.at(0), std::stod(f.at(1))}];
    EXPECT_EQ(std::stoull(f.at(2)), set.plain.size());
    set.plain.emplace_back();
    set.weighted.emplace_back();
    for (std::size_t k = 0; k < 8; ++k) {
      set.plain.back()[k] = std::stod(f.at(3 + k));
      set.weighted.back()[k] = std::stod(f.at(11 + k));
    }
  }
  return sets;
}

// Largest difference, divided by 1 + the size of the reference.
double worst_difference(const std::vector<BallGradient>& found,
                        const std::vector<EightNumbers>& expected) {
  double most = found.size() == expected.size() ? 0 : std::nan("");
  for (std::size_t i = 0; i < found.size() && i < expected.size(); ++i) {
    const EightNumbers numbers = numbers_of(found[i]);
    for (std::size_t k = 0; k < 8; ++k) {
      const double reference = expected[i][k];
      most = testing::worst(most, std::abs(numbers[k] - reference) / (1 + std::abs(reference)));
    }
  }
  return most;
}

// The bar of the references: 20 times what double loses with the formulas as they stand.
constexpr double kReferenceError = 1e-10;

TEST(UnionGradients, References) {
  VDWMESH_NEEDS_SHARED("reference/gradients.csv");
  std::size_t rows = 0;
  for (const auto& [key, reference] : reference_gradients()) {
    SCOPED_TRACE(key.first + " " + std::to_string(key.second));
    const SphereSet spheres =
        testing::read_xyzr(testing::shared_path("reference/" + key.first + ".xyzr"), key.second);
    const std::vector<double> w = weights_of(spheres.size());
    const UnionGradients plain = union_gradients(spheres),
                         weighted =
                             union_gradients(spheres, {.area_weights = w, .volume_weights = w});
    EXPECT_LE(worst_difference(plain.gradients, reference.plain), kReferenceError);
    EXPECT_LE(worst_difference(weighted.gradients, reference.weighted), kReferenceError);
    rows += reference.plain.size();
  }
  constexpr std::size_t kRows = 2796;
  EXPECT_EQ(rows, kRows);
}

// The formulas for weights of 1, once more.
EightNumbers plain_gradient(const Sphere& ball, double area, std::span<const SharedFace> faces) {
  const double r = ball.radius;
  EightNumbers g{0, 0, 0, 2 * area / r, 0, 0, 0, area};
  for (const SharedFace& f : faces) {
    const auto [inverse, height, other_height] = f.plane;
    g[3] += f.angle * (r * r * inverse - height - r * f.other_radius * inverse);
    const double along = -f.angle * (r * other_height + f.other_radius * height) * inverse;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      g[k] += along * f.axis[axis] + (r - f.other_radius) * inverse * f.arc[axis];
      g[4 + k] -= f.area * f.axis[axis];
    }
  }
  return g;
}

// What the fallback gives, for every ball.
TEST(UnionGradients, TriangulationAgreesWithReferences) {
  VDWMESH_NEEDS_SHARED("reference/gradients.csv");
  for (const auto& [key, reference] : reference_gradients()) {
    SCOPED_TRACE(key.first + " " + std::to_string(key.second));
    const SphereSet spheres =
        testing::read_xyzr(testing::shared_path("reference/" + key.first + ".xyzr"), key.second);
    std::vector<SphereId> ids(spheres.size());
    std::iota(ids.begin(), ids.end(), SphereId{0});
    std::vector<NumberedBall> near;
    for (const SphereId id : ids) near.push_back({id, spheres[id]});
    std::ranges::reverse(ids);  // they may stand in any order
    std::vector<SphereMeasures> measures(spheres.size());
    std::vector<EightNumbers> found(spheres.size());
    FaceVisitor visitor;
    visitor.visit = [&](SphereId id, const Sphere& ball, double area, auto faces) {
      found[id] = plain_gradient(ball, area, faces);
    };
    visit_by_triangulation(ids, near, measures, visitor);
    double most = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (std::size_t k = 0; k < 8; ++k) {
        const double expected = reference.plain[i][k];
        most = testing::worst(most, std::abs(found[i][k] - expected) / (1 + std::abs(expected)));
      }
    }
    EXPECT_LE(most, kReferenceError);
  }
}

// Of two balls: dA_w/dd = 2 π (w₁ r₁ h₂ + w₂ r₂ h₁) / d and dV/dd = π ρ², with the heights h of the
// plane over the centres, and dV_w/dr from the same faces.
TEST(UnionGradients, TwoBallsInClosedForm) {
  const double r1 = 1.3, r2 = 0.9, d = 1.7;
  const std::vector<double> w{0.75, -1.5};
  const std::vector<Sphere> balls{{{0.2, 0.1, -0.3}, r1},
                                  {{0.2 + d * 2 / 3, 0.1 - d / 3, -0.3 + d * 2 / 3}, r2}};
  const Vec3d n{2.0 / 3, -1.0 / 3, 2.0 / 3};
  const double h1 = (d * d + r1 * r1 - r2 * r2) / (2 * d), h2 = d - h1, squared = r1 * r1 - h1 * h1;
  const double by_distance = 2 * pi * (w[0] * r1 * h2 + w[1] * r2 * h1) / d;
  const BallGradient g = with_weights(balls, w, {}).gradients[1];
  constexpr double kError = 1e-14;  // a dozen roundings of numbers below 10
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(g.area_center[axis], by_distance * n[axis], kError);
    EXPECT_NEAR(g.volume_center[axis], pi * squared * n[axis], kError);
  }
  // The area of a sphere of radius r less a cap of height r - h is 2 π r (r + h).
  const double dh1 = -r2 / d, dh2 = r2 / d;  // by r2
  EXPECT_NEAR(g.area_radius, w[0] * 2 * pi * r1 * dh1 + w[1] * 2 * pi * (2 * r2 + h2 + r2 * dh2),
              kError);
  EXPECT_NEAR(g.volume_radius, 2 * pi * r2 * (r2 + h2), kError);
}

void expect_identities(const std::vector<Sphere>& balls, testing::Dice& dice) {
  const SphereSet spheres(balls);
  const std::vector<double> w = any_weights(dice, balls.size()),
                            u = any_weights(dice, balls.size());
  const UnionGradients g = union_gradients(spheres, {.area_weights = w, .volume_weights = u});
  testing::GradientIdentities identities(balls[0].center);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    identities.add(balls[i], g.gradients[i]);
    identities.add_scaling(-2 * w[i] * g.per_sphere[i].area, -3 * u[i] * g.per_sphere[i].volume);
  }
  // Terms are right to 1e-12 of their sizes, those of balls near a doubt to 1e-9.
  identities.expect_within(1e-9);
}

TEST(UnionGradients, IdentitiesOnSetsUnlikeProteins) {
  constexpr unsigned kSets = 2000;
  testing::for_sets_of_families(kSets, [](const std::vector<Sphere>& balls, testing::Dice& dice,
                                          unsigned) { expect_identities(balls, dice); });
}

// With w = u = 1: dV/dr is the exposed area.
TEST(UnionGradients, VolumeGrowsByArea) {
  testing::for_sets_of_families(210,
                                [](const std::vector<Sphere>& balls, testing::Dice&, unsigned) {
                                  const UnionGradients g = union_gradients(SphereSet(balls));
                                  for (std::size_t i = 0; i < balls.size(); ++i) {
                                    EXPECT_EQ(g.gradients[i].volume_radius, g.per_sphere[i].area);
                                  }
                                });
}

// ⟨weights, rates of a motion⟩ = ⟨gradient of the weights, motion⟩, and the same by the Jacobian.
TEST(UnionGradients, RatesAndJacobianAreTheSameMap) {
  const auto check = [](const std::vector<Sphere>& balls, testing::Dice& dice, unsigned) {
    const SphereSet spheres(balls);
    const std::vector<double> w = any_weights(dice, balls.size()),
                              u = any_weights(dice, balls.size());
    std::vector<Vec3d> moves(balls.size());
    std::vector<double> growths(balls.size());
    for (std::size_t i = 0; i < balls.size(); ++i) {
      moves[i] = testing::random_point(dice, 1);
      growths[i] = dice.real(-1, 1);
    }
    const UnionGradients g = union_gradients(spheres, {.area_weights = w, .volume_weights = u});
    const std::vector<SphereMeasures> rates = measure_rates(spheres, moves, growths);
    const UnionJacobian jacobian = union_jacobian(spheres);
    const auto along = [&](const Vec3d& center, double radius, std::size_t i) {
      return dot(center, moves[i]) + radius * growths[i];
    };
    Balance area, volume;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const BallGradient& d = g.gradients[i];
      area.add(along(d.area_center, d.area_radius, i));
      volume.add(along(d.volume_center, d.volume_radius, i));
      area.add(-w[i] * rates[i].area);
      volume.add(-u[i] * rates[i].volume);
      Balance row_area, row_volume;
      for (std::size_t e = jacobian.first[i]; e < jacobian.first[i + 1]; ++e) {
        const BallGradient& b = jacobian.blocks[e];
        row_area.add(along(b.area_center, b.area_radius, jacobian.columns[e]));
        row_volume.add(along(b.volume_center, b.volume_radius, jacobian.columns[e]));
      }
      constexpr double kRounding = 1e-12;  // of some hundred terms
      EXPECT_NEAR(row_area.sum, rates[i].area, kRounding * (1 + row_area.size));
      EXPECT_NEAR(row_volume.sum, rates[i].volume, kRounding * (1 + row_volume.size));
    }
    EXPECT_LE(std::abs(area.sum), 1e-9 * (1 + area.size));
    EXPECT_LE(std::abs(volume.sum), 1e-9 * (1 + volume.size));
  };
  testing::for_sets_of_families(210, check);
}

TEST(UnionGradients, MeasuresHaveTheBitsOfTheUnion) {
  testing::for_sets_of_families(
      210, [](const std::vector<Sphere>& balls, testing::Dice&, unsigned) {
        const SphereSet spheres(balls);
        const UnionGradients g = union_gradients(spheres);
        const ExactUnion u = exact_union(spheres, {.topology = TopologyRequest::none});
        EXPECT_EQ(g.area, u.area);
        EXPECT_EQ(g.volume, u.volume);
        EXPECT_EQ(g.fallback_spheres, u.fallback_spheres);
        for (std::size_t i = 0; i < balls.size(); ++i) {
          EXPECT_EQ(g.per_sphere[i].area, u.per_sphere[i].area);
          EXPECT_EQ(g.per_sphere[i].volume, u.per_sphere[i].volume);
        }
      });
}

TEST(UnionGradients, SameBytesForAnyNumberOfThreads) {
  testing::Dice dice(7);
  std::vector<Sphere> balls;
  for (int i = 0; i < 5000; ++i) {
    balls.push_back({testing::random_point(dice, 20), dice.real(0.8, 1.9)});
  }
  const SphereSet spheres(balls);
  const std::vector<double> w = any_weights(dice, balls.size());
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return union_gradients(spheres, {.area_weights = w, .volume_weights = w}).gradients;
  };
  const auto one = run(1);
  EXPECT_TRUE(same_bytes(one, run(2)));
  EXPECT_TRUE(same_bytes(one, run(8)));
}

TEST(UnionGradients, FollowTheBallsWhenRenumbered) {
  const auto check = [](const std::vector<Sphere>& balls, testing::Dice& dice, unsigned) {
    std::vector<std::size_t> order(balls.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = order.size(); i > 1; --i) {
      std::swap(order[i - 1],
                order[static_cast<std::size_t>(dice.whole(0, static_cast<int>(i) - 1))]);
    }
    const std::vector<double> w = any_weights(dice, balls.size());
    std::vector<Sphere> moved;
    std::vector<double> moved_w;
    for (const std::size_t i : order) {
      moved.push_back(balls[i]);
      moved_w.push_back(w[i]);
    }
    const auto first = union_gradients(SphereSet(balls), {.area_weights = w, .volume_weights = w});
    const auto second =
        union_gradients(SphereSet(moved), {.area_weights = moved_w, .volume_weights = moved_w});
    std::vector<BallGradient> expected;
    for (const std::size_t i : order) expected.push_back(first.gradients[i]);
    EXPECT_TRUE(same_bytes(expected, second.gradients));
  };
  testing::for_sets_of_families(700, check);
}

TEST(UnionGradients, LinearInTheWeights) {
  testing::Dice dice(3);
  const std::vector<Sphere> balls = testing::chain(dice);
  const std::vector<double> w = any_weights(dice, balls.size()),
                            v = any_weights(dice, balls.size());
  std::vector<double> sum;
  for (std::size_t i = 0; i < w.size(); ++i) sum.push_back(2 * w[i] - v[i]);
  for (std::size_t i = 0; i < w.size(); ++i) {
    const EightNumbers a = numbers_of(with_weights(balls, w, w).gradients[i]),
                       b = numbers_of(with_weights(balls, v, v).gradients[i]),
                       both = numbers_of(with_weights(balls, sum, sum).gradients[i]);
    for (std::size_t k = 0; k < 8; ++k) {
      EXPECT_NEAR(both[k], 2 * a[k] - b[k], 1e-12 * (1 + std::abs(a[k]) + std::abs(b[k])));
    }
  }
}

// A quarter turn about an axis permutes coordinates, exactly.
TEST(UnionGradients, TurnWithTheBalls) {
  const auto turn = [](const Vec3d& v) { return Vec3d{-v.y, v.x, v.z}; };
  testing::Dice dice(5);
  std::vector<Sphere> balls = testing::chain(dice), turned = balls;
  for (Sphere& s : turned) s.center = turn(s.center);
  const std::vector<double> w = any_weights(dice, balls.size());
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const BallGradient g = with_weights(balls, w, w).gradients[i],
                       t = with_weights(turned, w, w).gradients[i];
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(t.area_center[axis], turn(g.area_center)[axis], 1e-12);
      EXPECT_NEAR(t.volume_center[axis], turn(g.volume_center)[axis], 1e-12);
    }
    EXPECT_NEAR(t.area_radius, g.area_radius, 1e-12);
    EXPECT_NEAR(t.volume_radius, g.volume_radius, 1e-12);
  }
}

TEST(UnionGradients, TouchingBallsAreAlone) {
  const UnionGradients g = union_gradients(SphereSet({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}}));
  EXPECT_EQ(g.kink_spheres, 2u);
  for (const BallGradient& d : g.gradients) {
    EXPECT_EQ(numbers_of(d), (EightNumbers{0, 0, 0, 8 * pi, 0, 0, 0, 4 * pi}));
  }
}

TEST(UnionGradients, OfEqualBallsTheFirstCounts) {
  const std::vector<Sphere> balls{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{1, 0, 0}, 1}};
  const std::vector<double> w{1, 2, 100};
  const UnionGradients g =
      union_gradients(SphereSet(balls), {.area_weights = w, .volume_weights = w});
  EXPECT_EQ(g.kink_spheres, 1u);
  EXPECT_EQ(numbers_of(g.gradients[2]), EightNumbers{});
  const std::vector<double> two{1, 2};
  const UnionGradients alone = union_gradients(SphereSet({balls[0], balls[1]}),
                                               {.area_weights = two, .volume_weights = two});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(numbers_of(g.gradients[i]), numbers_of(alone.gradients[i]));
  }
}

TEST(UnionGradients, SwallowedBallsHaveNone) {
  const UnionGradients g = union_gradients(
      SphereSet({{{0, 0, 0}, 2}, {{0.5, 0, 0}, 1}, {{0, 1, 0}, 1}, {{0, 0, 0}, 1.5}}));
  EXPECT_EQ(numbers_of(g.gradients[0]), (EightNumbers{0, 0, 0, 16 * pi, 0, 0, 0, 16 * pi}));
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(numbers_of(g.gradients[i]), EightNumbers{});
  EXPECT_EQ(g.kink_spheres, 1u);  // the third touches the first from inside
}

TEST(UnionGradients, RefusesWhatIsNoWeight) {
  const SphereSet two({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  const std::vector<double> one{1}, nan{1, std::nan("")};
  EXPECT_THROW(union_gradients(two, {.area_weights = one}), InvalidInput);
  EXPECT_THROW(union_gradients(two, {.volume_weights = nan}), InvalidInput);
  EXPECT_THROW(union_gradients(SphereSet(std::vector<Sphere>{})), InvalidInput);
  EXPECT_THROW(measure_rates(two, {}, one), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
