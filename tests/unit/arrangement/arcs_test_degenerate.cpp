// Small sets on integer grids, where almost everything is degenerate, with and without jitter: a
// sphere that the arcs do not doubt agrees with the regular triangulation, which has exact
// predicates.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "measures/arcs/arcs.hpp"
#include "measures/exact_union.hpp"

namespace vdwmesh {
namespace {

// Of the unit ball, issue 3: agreement on degenerate sets. A doubt is raised when rounding could do
// more than this.
constexpr double kDegenerate = 1e-9;

template <class T, std::size_t N>
T pick(const T (&values)[N], std::mt19937& random) {
  return values[random() % N];
}

std::vector<Sphere> random_set(std::mt19937& random) {
  constexpr double kRadii[] = {0.5,
                               0.7071067811865476,
                               0.8660254037844386,
                               1.0,
                               1.118033988749895,
                               1.25,
                               1.4142135623730951,
                               1.5,
                               2.0,
                               3.0};
  constexpr double kJitters[] = {0,     0,     0,     1e-15, 1e-14, 1e-13,
                                 1e-12, 1e-11, 1e-10, 1e-9,  1e-8,  1e-6};
  const double jitter = pick(kJitters, random);
  const double spacing = random() % 2 ? 1 : 0.5;
  const bool centred = random() % 3 == 0, planar = random() % 3 == 0, turned = random() % 2;
  const unsigned side = 2 + random() % 4;
  const double radii[] = {pick(kRadii, random), pick(kRadii, random)};
  std::uniform_real_distribution<double> shift(-jitter, jitter);
  std::vector<Sphere> spheres(2 + random() % 24);
  for (Sphere& s : spheres) {
    Vec3d c{};
    for (int axis = 0; axis < 3; ++axis) c[axis] = spacing * static_cast<double>(random() % side);
    if (planar) c.z = 0;
    if (centred && random() % 2) c = c + Vec3d{0.5, 0.5, 0.5};
    if (turned) {
      c = {(2 * c.x - 2 * c.y + c.z) / 3, (c.x + 2 * c.y + 2 * c.z) / 3,
           (-2 * c.x - c.y + 2 * c.z) / 3};
    }
    s.center = c + Vec3d{shift(random), shift(random), shift(random)};
    s.radius = pick(radii, random) + shift(random);
  }
  return spheres;
}

// Two balls that all but coincide, small ones on the circle between them and on those.
std::vector<Sphere> twins_set(std::mt19937& random) {
  constexpr Vec3d kDirections[] = {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {1, 0, 0},        {0, -1, 0},
                                   {0, 0, 1},     {0, 0, -1},     {0.48, 0.64, 0.6}};
  const auto power = [&](int least, int most) {
    return std::ldexp(1.0,
                      least + static_cast<int>(random() % static_cast<unsigned>(most - least)));
  };
  const double radius = pick({1.5, 1.0, 2.5}, random);
  std::vector<Sphere> spheres{{{0.5, -2.5, 3}, radius}, {{0.5, -2.5, 3}, radius}};
  spheres[1].center[static_cast<int>(random() % 3)] += power(-50, -20);
  for (std::size_t more = 2 + random() % 8; more > 0; --more) {
    const Sphere& on = spheres[random() % spheres.size()];
    const double size = power(-12, 0);
    spheres.push_back({on.center + std::max(on.radius, size) * pick(kDirections, random), size});
  }
  return spheres;
}

// The number of spheres that the arcs trusted.
std::size_t expect_agreement(unsigned sets, std::vector<Sphere> (*make)(std::mt19937&)) {
  std::size_t trusted = 0;
  for (unsigned seed = 0; seed < sets; ++seed) {
    std::mt19937 random(seed);
    const SphereSet spheres(make(random));
    const ArcMeasures arcs = arc_measures(spheres);
    const ExactUnion exact = exact_union(spheres);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (std::binary_search(arcs.suspect.begin(), arcs.suspect.end(), i)) continue;
      ++trusted;
      const double r = spheres[i].radius;
      EXPECT_NEAR(arcs.per_sphere[i].area, exact.per_sphere[i].area, kDegenerate * r * r)
          << "set " << seed << ", sphere " << i;
      EXPECT_NEAR(arcs.per_sphere[i].volume, exact.per_sphere[i].volume, kDegenerate * r * r * r)
          << "set " << seed << ", sphere " << i;
    }
  }
  return trusted;
}

// The arcs must not doubt everything either.
TEST(ArcsDegenerate, WhatIsNotDoubtedAgreesWithTheTriangulation) {
  constexpr unsigned kSets = 3000;
  EXPECT_GT(expect_agreement(kSets, random_set), kSets);
}

TEST(ArcsDegenerate, AmongTwinsToo) {
  constexpr unsigned kSets = 6000;
  EXPECT_GT(expect_agreement(kSets, twins_set), kSets / 2);
}

// A ball half in two that all but coincide: planes a hair apart each took the other's chord in the
// cap of a tiny ball, and with it all of the ball.
TEST(ArcsDegenerate, ABallOnTheCircleOfTwinsIsKept) {
  const SphereSet spheres({{{0.5, -2.5, 3.0}, 1.5},
                           {{0.5, -2.5, 3.000000001862645}, 1.5},
                           {{1.4, -1.2999999999999998, 3.0625}, 0.0625},
                           {{1.4, -1.2999999999999998, 3.0}, 0.000244140625}});
  const double distance = std::hypot(1.5, 0.0625), r = 0.0625;
  const double cosine = (distance * distance + r * r - 1.5 * 1.5) / (2 * distance * r);
  const double outside = 2 * std::numbers::pi * r * r * (1 + cosine);  // of either twin
  const double tiny =
      std::numbers::pi * 0.000244140625 * 0.000244140625;  // what the tiny ball hides
  const ExactUnion exact = exact_union(spheres, {UnionMethod::arcs, nullptr});
  EXPECT_NEAR(exact.per_sphere[2].area, outside, tiny);
}

}  // namespace
}  // namespace vdwmesh
