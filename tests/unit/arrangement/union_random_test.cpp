// The exact union of random sets of fixed seeds, free and degenerate: two methods that share
// nothing agree, and neither place, order, direction nor threads matter.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "support/dice.hpp"
#include "union_cases.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;
using testing::unite;

constexpr unsigned kFreeSets = 1500, kDegenerateSets = 1500;

// Relative to the total. Arcs and triangulation share nothing but the input.
constexpr double kMethods = 1e-12;
// Relative, by issue 3: a rotation rounds the coordinates.
constexpr double kMotion = 1e-9;

// Coordinates of 20 binary places, so that shifts by whole numbers are exact.
double dyadic(double value) { return std::ldexp(std::round(std::ldexp(value, 20)), -20); }

std::vector<Sphere> free_set(Dice& dice) {
  const int count = dice.whole(2, 30);
  const double half = std::cbrt(dice.real(3, 30) * count) / 2;
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const auto place = [&] { return dyadic(dice.real(-half, half)); };
    const double x = place(), y = place(), z = place();
    spheres.push_back({{x, y, z}, dyadic(dice.real(0.3, 2.2))});
  }
  return spheres;
}

std::vector<Sphere> degenerate_set(unsigned seed) {
  std::mt19937_64 random(seed);
  return testing::degenerate_grid(random);
}

void expect_methods_agree(const std::vector<Sphere>& spheres, const ExactUnion& u) {
  const ExactUnion arcs = unite(spheres, UnionMethod::arcs);
  EXPECT_RELATIVE(arcs.area, u.area, kMethods);
  EXPECT_RELATIVE(arcs.volume, u.volume, kMethods);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    EXPECT_NEAR(arcs.per_sphere[i].volume, u.per_sphere[i].volume, kMethods * u.volume);
  }
}

void expect_same(const ExactUnion& v, const ExactUnion& u, double tolerance) {
  EXPECT_RELATIVE(v.area, u.area, tolerance);
  EXPECT_RELATIVE(v.volume, u.volume, tolerance);
  EXPECT_EQ(v.topology->components, u.topology->components);
  EXPECT_EQ(v.topology->tunnels, u.topology->tunnels);
  EXPECT_EQ(v.topology->voids, u.topology->voids);
  EXPECT_EQ(v.topology->point_contacts, u.topology->point_contacts);
}

void expect_place_does_not_matter(std::vector<Sphere> spheres, const ExactUnion& u) {
  for (Sphere& s : spheres) s.center = s.center + Vec3d{1024, -2048, 4096};
  expect_same(unite(spheres), u, kMethods);
}

void expect_order_does_not_matter(const std::vector<Sphere>& spheres, const ExactUnion& u,
                                  unsigned seed) {
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(seed));
  std::vector<Sphere> permuted;
  for (const std::size_t i : order) permuted.push_back(spheres[i]);
  const ExactUnion v = unite(permuted);
  expect_same(v, u, 0);
}

// Axes change places, which is exact; tangent balls stay tangent.
void expect_axes_do_not_matter(std::vector<Sphere> spheres, const ExactUnion& u) {
  for (Sphere& s : spheres) s.center = {s.center.y, s.center.z, s.center.x};
  expect_same(unite(spheres), u, kMethods);
}

void expect_rotation_does_not_matter(std::vector<Sphere> spheres, const ExactUnion& u, Dice& dice) {
  const double a = dice.real(0, 7), b = dice.real(0, 7);
  const double c = std::cos(a), s = std::sin(a), d = std::cos(b), e = std::sin(b);
  for (Sphere& ball : spheres) {
    const Vec3d p = ball.center;
    const Vec3d q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    ball.center = {q.x, d * q.y - e * q.z, e * q.y + d * q.z};
  }
  expect_same(unite(spheres), u, kMotion);
}

// The same bits.
void expect_threads_do_not_matter(const std::vector<Sphere>& spheres, const ExactUnion& u) {
  for (const std::size_t threads : {1u, 3u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const ExactUnion v = unite(spheres);
    expect_same(v, u, 0);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      EXPECT_EQ(v.per_sphere[i].area, u.per_sphere[i].area);
      EXPECT_EQ(v.per_sphere[i].volume, u.per_sphere[i].volume);
    }
  }
}

void expect_properties(const std::vector<Sphere>& spheres, const ExactUnion& u, unsigned seed) {
  expect_methods_agree(spheres, u);
  expect_place_does_not_matter(spheres, u);
  expect_order_does_not_matter(spheres, u, seed);
  expect_axes_do_not_matter(spheres, u);
  expect_threads_do_not_matter(spheres, u);
}

TEST(UnionRandom, FreeSets) {
  for (unsigned seed = 1; seed <= kFreeSets && !HasFailure(); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Dice dice(seed);
    const std::vector<Sphere> spheres = free_set(dice);
    const ExactUnion u = unite(spheres);
    expect_properties(spheres, u, seed);
    expect_rotation_does_not_matter(spheres, u, dice);
  }
}

TEST(UnionRandom, DegenerateSets) {
  for (unsigned seed = 1; seed <= kDegenerateSets && !HasFailure(); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    const std::vector<Sphere> spheres = degenerate_set(seed);
    expect_properties(spheres, unite(spheres), seed);
  }
}

// Balls of sizes e^-10 to e^5 on the surface of another, touching it from inside or outside, or
// nearly.
std::vector<Sphere> sizes_far_apart(Dice& dice) {
  const auto size = [&] { return std::exp(dice.real(-5, 5)); };
  std::vector<Sphere> spheres{{{0, 0, 0}, size()}};
  const double side = dice.whole(-1, 1);
  for (int i = 0; i < 5; ++i) {
    const double radius = (i % 2 == 0 ? 0.01 : 1) * size();
    const Vec3d towards{dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)};
    const double near = 1 + dice.real(-1, 1) * std::pow(10, -dice.real(0, 8));
    const double distance = std::abs(spheres[0].radius + side * radius) * near;
    spheres.push_back({(distance / norm(towards)) * towards, radius});
  }
  return spheres;
}

// Their circles are small on the larger of two balls.
TEST(UnionRandom, FormulaSetsAgreeWhereSizesAreFarApart) {
  constexpr double kFormulas = 1e-11;
  Dice dice(11);
  for (int n = 0; n < 5000; ++n) {
    SCOPED_TRACE(n);
    const std::vector<Sphere> spheres = sizes_far_apart(dice);
    const ExactUnion u = unite(spheres);
    EXPECT_RELATIVE(*u.check_area, u.area, kFormulas);
    EXPECT_RELATIVE(*u.check_volume, u.volume, kFormulas);
  }
}

}  // namespace
}  // namespace vdwmesh
