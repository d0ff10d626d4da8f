// Exact area and volume from exposed arcs, against closed forms, published sets and symmetries.
#include "measures/arcs/arcs.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "measures/exact_sum.hpp"
#include "measures/total_measures.hpp"

namespace vdwmesh {
namespace {

constexpr double kPi = std::numbers::pi;

// Relative. A few hundred roundings of 1.1e-16 on numbers of the size of the result.
constexpr double kClosedForm = 1e-13;
// Relative: where planes meet in too many points for the arcs, and the triangulation takes over.
constexpr double kDegenerate = 1e-9;
// Relative: invariance under motions that round the coordinates.
constexpr double kMotion = 1e-9;

#define EXPECT_REL(actual, expected, tolerance)                                          \
  EXPECT_TRUE(std::abs((actual) - (expected)) <= (tolerance)*std::abs(expected))         \
      << #actual " = " << (actual) << ", expected " << (expected) << ", relative error " \
      << (actual) / (expected)-1

// What the plane at signed distance h from the centre leaves of a ball, on the centre's side.
SphereMeasures cut_ball(double r, double h) {
  const double lost = r - h;
  return {4 * kPi * r * r - 2 * kPi * r * lost,
          4 * kPi / 3 * r * r * r - kPi * lost * lost * (3 * r - lost) / 3};
}

SphereMeasures operator+(const SphereMeasures& a, const SphereMeasures& b) {
  return {a.area + b.area, a.volume + b.volume};
}

std::vector<Sphere> random_spheres(std::size_t count, double side, double r_min, double r_max,
                                   unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, side), radius(r_min, r_max);
  std::vector<Sphere> spheres(count);
  for (Sphere& s : spheres) s = {{place(random), place(random), place(random)}, radius(random)};
  return spheres;
}

std::vector<Sphere> lattice(int side, double spacing, double radius) {
  std::vector<Sphere> spheres;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        spheres.push_back({{spacing * x, spacing * y, spacing * z}, radius});
      }
    }
  }
  return spheres;
}

std::vector<Sphere> jittered(std::vector<Sphere> spheres, double jitter, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> shift(-jitter, jitter);
  for (Sphere& s : spheres) {
    s.center = s.center + Vec3d{shift(random), shift(random), shift(random)};
    s.radius += shift(random);
  }
  return spheres;
}

// A rotation with rational entries: rows of length 3, divided by 3.
Vec3d rotated(const Vec3d& c) {
  return {(2 * c.x - 2 * c.y + c.z) / 3, (c.x + 2 * c.y + 2 * c.z) / 3,
          (-2 * c.x - c.y + 2 * c.z) / 3};
}

struct Measured {
  double area, volume;
  std::vector<SphereMeasures> per_sphere;
  std::vector<SphereId> suspect;
};

// What users get: suspect spheres have the measures of the triangulation.
Measured measure(std::vector<Sphere> balls) {
  const SphereSet spheres(std::move(balls));
  const ExactUnion exact = exact_union(spheres, {UnionMethod::arcs, nullptr});
  return {exact.area, exact.volume, exact.per_sphere, arc_measures(spheres).suspect};
}

TEST(Arcs, OneBall) {
  const Measured m = measure({{{1, 2, 3}, 1.7}});
  EXPECT_REL(m.area, 4 * kPi * 1.7 * 1.7, kClosedForm);
  EXPECT_REL(m.volume, 4 * kPi / 3 * 1.7 * 1.7 * 1.7, kClosedForm);
  EXPECT_TRUE(m.suspect.empty());
}

TEST(Arcs, NoSpheresIsRefused) { EXPECT_THROW(arc_measures(SphereSet()), InvalidInput); }

TEST(Arcs, LensOfTwoBalls) {
  const double r = 1.7, s = 1.2, d = 1.5;
  const double h = (d * d + r * r - s * s) / (2 * d);
  const SphereMeasures first = cut_ball(r, h), second = cut_ball(s, d - h);
  const Measured m = measure({{{0, 0, 0}, r}, {{0, d, 0}, s}});
  EXPECT_REL(m.per_sphere[0].area, first.area, kClosedForm);
  EXPECT_REL(m.per_sphere[0].volume, first.volume, kClosedForm);
  EXPECT_REL(m.per_sphere[1].area, second.area, kClosedForm);
  EXPECT_REL(m.per_sphere[1].volume, second.volume, kClosedForm);
  EXPECT_REL(m.area, (first + second).area, kClosedForm);
  EXPECT_REL(m.volume, (first + second).volume, kClosedForm);
}

TEST(Arcs, ChainOfBalls) {
  const double r = 1.5, d = 2.0;
  std::vector<Sphere> chain;
  for (int i = 0; i < 33; ++i)
    chain.push_back({{d * i / std::sqrt(2), 1, d * i / std::sqrt(2)}, r});
  const SphereMeasures end = cut_ball(r, d / 2), ball = cut_ball(r, r);
  const Measured m = measure(chain);
  EXPECT_REL(m.area, 32 * 2 * end.area - 31 * ball.area, kClosedForm);
  EXPECT_REL(m.volume, 32 * 2 * end.volume - 31 * ball.volume, kClosedForm);
}

TEST(Arcs, PerSphereValuesSumToTheTotals) {
  const Measured m = measure(random_spheres(2000, 20, 1, 2, 1));
  double area = 0, volume = 0;
  for (const SphereMeasures& s : m.per_sphere) {
    area += s.area;
    volume += s.volume;
  }
  EXPECT_REL(area, m.area, 1e-12);
  EXPECT_REL(volume, m.volume, 1e-12);
}

TEST(Arcs, TwoCapsThatDoNotMeet) {
  const double r = 1;
  const Measured m = measure({{{0, 0, 0}, r}, {{1.8, 0, 0}, r}, {{0, 1.8, 0}, r}});
  const SphereMeasures ball = cut_ball(r, r), cut = cut_ball(r, 0.9);
  EXPECT_REL(m.per_sphere[0].area, 2 * cut.area - ball.area, kClosedForm);
  EXPECT_REL(m.per_sphere[0].volume, 2 * cut.volume - ball.volume, kClosedForm);
}

TEST(Arcs, DuplicatesBelongToTheLowestIndex) {
  const std::vector<Sphere> pair{{{0, 0, 0}, 1.7}, {{1.1, 0.3, 0.2}, 1.5}, {{0.2, 1.1, 0.4}, 1.6}};
  std::vector<Sphere> doubled;
  for (const Sphere& s : pair) doubled.insert(doubled.end(), {s, s, s});
  const Measured single = measure(pair), m = measure(doubled);
  EXPECT_TRUE(m.suspect.empty());
  for (std::size_t i = 0; i < doubled.size(); ++i) {
    EXPECT_EQ(m.per_sphere[i].area, i % 3 == 0 ? single.per_sphere[i / 3].area : 0);
    EXPECT_EQ(m.per_sphere[i].volume, i % 3 == 0 ? single.per_sphere[i / 3].volume : 0);
  }
}

TEST(Arcs, NestedConcentricAndInsideTangentBallsCountNothing) {
  const double r = 2;
  const Measured m = measure({{{0.3, 0, 0}, 1}, {{0, 0, 0}, r}, {{0, 0, 0}, 1.5}, {{0, 1, 0}, 1}});
  for (const int i : {0, 2, 3}) EXPECT_EQ(m.per_sphere[static_cast<std::size_t>(i)].area, 0);
  EXPECT_REL(m.area, 4 * kPi * r * r, kClosedForm);
  EXPECT_REL(m.volume, 4 * kPi / 3 * r * r * r, kClosedForm);
}

TEST(Arcs, TangentBallsKeepTheirArea) {
  const Measured m = measure(lattice(5, 1, 0.5));
  EXPECT_REL(m.area, 125 * 4 * kPi * 0.25, kClosedForm);
  EXPECT_REL(m.volume, 125 * 4 * kPi / 3 * 0.125, kClosedForm);
}

// Balls of radius 1, each overlapping its six neighbours at distance 1.5 and no others.
TEST(Arcs, LatticeOfLenses) {
  const SphereMeasures cut = cut_ball(1, 0.75), ball = cut_ball(1, 1);
  const double edges = 3 * 6 * 6 * 5;
  const Measured m = measure(lattice(6, 1.5, 1));
  EXPECT_TRUE(m.suspect.empty());
  EXPECT_REL(m.area, 216 * ball.area - 2 * edges * (ball.area - cut.area), 1e-12);
  EXPECT_REL(m.volume, 216 * ball.volume - 2 * edges * (ball.volume - cut.volume), 1e-12);
}

// Inner balls of a lattice whose cells the balls just cover, or cover with room: the power cell is
// the unit cube, nothing is exposed, and eight planes and more meet in each of its corners.
TEST(Arcs, CubesInsideALattice) {
  for (const double radius : {std::sqrt(0.75), 0.9, 1.0, 1.3, 2.0}) {
    for (const double jitter : {0.0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10}) {
      const Measured m = measure(jittered(lattice(5, 1, radius), jitter, 11));
      const std::size_t center = 62;  // of 5 x 5 x 5
      EXPECT_NEAR(m.per_sphere[center].area, 0, kDegenerate) << radius << " " << jitter;
      EXPECT_NEAR(m.per_sphere[center].volume, 1, kDegenerate) << radius << " " << jitter;
    }
  }
}

// The planes of a ring of balls all contain its axis: wedges, like the slices of a cake.
TEST(Arcs, RingsSplitIntoEqualWedges) {
  for (const int count : {3, 6, 12, 24, 40}) {
    std::vector<Sphere> ring;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * kPi * i / count;
      ring.push_back({rotated({1.4 * std::cos(angle), 1.4 * std::sin(angle), 0}), 1.7});
    }
    for (const double jitter : {0.0, 1e-15, 1e-14}) {
      const Measured m = measure(jittered(ring, jitter, 14));
      for (std::size_t i = 0; i < ring.size(); ++i) {
        EXPECT_REL(m.per_sphere[i].area, m.area / count, kDegenerate) << count << " " << jitter;
        EXPECT_REL(m.per_sphere[i].volume, m.volume / count, kDegenerate) << count << " " << jitter;
      }
    }
  }
}

// The balls of a cubic lattice touch the edges of their cells: lenses that touch one another.
TEST(Arcs, LatticeOfBallsThatTouchTheirCellsEdges) {
  const double r = std::sqrt(0.5);
  const SphereMeasures cut = cut_ball(r, 0.5), ball = cut_ball(r, r);
  for (const double jitter : {0.0, 1e-15, 1e-14, 1e-13, 1e-12}) {
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
      const Measured m = measure(jittered(lattice(5, 1, r), jitter, seed));
      const double caps = 2 * 3 * 5 * 5 * 4;
      EXPECT_REL(m.area, 125 * ball.area - caps * (ball.area - cut.area), kDegenerate) << jitter;
      EXPECT_REL(m.volume, 125 * ball.volume - caps * (ball.volume - cut.volume), kDegenerate)
          << jitter;
    }
  }
}

// All surfaces pass through the origin, whose surroundings are covered. What the arcs vouch for
// must not depend on which way the jitter opens or closes the point.
TEST(Arcs, BallsThroughOneCoveredPoint) {
  std::mt19937_64 random(16);
  std::normal_distribution<double> direction;
  std::vector<Sphere> spheres;
  for (int i = 0; i < 40; ++i) {
    Vec3d u{direction(random), direction(random), direction(random)};
    spheres.push_back({(2 / norm(u)) * u, 2});
  }
  const Measured open = measure(jittered(spheres, 1e-8, 17));
  for (const double jitter : {0.0, 1e-15, 1e-14, 1e-13, 1e-12}) {
    for (const unsigned seed : {18u, 19u, 20u}) {
      const Measured m = measure(jittered(spheres, jitter, seed));
      // The surface of each of 40 balls moves by 3e-8 at most.
      EXPECT_NEAR(m.area, open.area, 3e-8 * 40 * 8 * kPi * 2) << jitter;
      EXPECT_NEAR(m.volume, open.volume, 3e-8 * 40 * 4 * kPi * 4) << jitter;
    }
  }
}

TEST(Arcs, FourCirclesThroughOnePointAreSuspect) {
  // The planes of the four outer balls meet in (0, 0, 1) on the first.
  std::vector<Sphere> spheres{{{0, 0, 0}, 1}};
  for (const Vec3d& u :
       {Vec3d{0.6, 0, 0.8}, Vec3d{-0.6, 0, 0.8}, Vec3d{0, 0.6, 0.8}, Vec3d{0, -0.6, 0.8}}) {
    spheres.push_back({1.6 * u, 1});
  }
  const Measured m = measure(spheres);
  ASSERT_FALSE(m.suspect.empty());
  EXPECT_EQ(m.suspect.front(), 0u);
}

// Near duplicates of near duplicates: no jitter may change the sums by more than it could.
TEST(Arcs, JitterChangesLittle) {
  const std::vector<Sphere> cluster = random_spheres(20, 3.5, 1, 1.8, 12);
  const Measured single = measure(cluster);
  for (const double jitter : {1e-15, 1e-13, 1e-11, 1e-9, 1e-8, 1e-7, 1e-6}) {
    std::vector<Sphere> spheres = cluster;
    for (const Sphere& s : jittered(cluster, jitter, 13)) spheres.push_back(s);
    const Measured m = measure(spheres);
    // A radius and a center that move by e each move the surface by at most (1 + sqrt 3) e, and
    // dA/dr is below 8 pi r.
    const double tolerance = 2.74 * jitter * 20 * 8 * kPi * 1.8 + kDegenerate * single.area;
    EXPECT_NEAR(m.area, single.area, tolerance) << jitter;
    EXPECT_NEAR(m.volume, single.volume, tolerance) << jitter;
  }
}

TEST(Arcs, BallCoveredByManyIsFoundBuried) {
  std::vector<Sphere> spheres{{{0, 0, 0}, 1}};
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) spheres.push_back({{0.6 * x, 0.61 * y, 0.62 * z}, 1.2});
    }
  }
  const Measured m = measure(spheres);
  EXPECT_EQ(m.per_sphere[0].area, 0);
  EXPECT_GE(m.per_sphere[0].volume, 0);
  spheres.erase(spheres.begin());
  EXPECT_REL(m.area, measure(spheres).area, kDegenerate);
  EXPECT_REL(m.volume, measure(spheres).volume, kDegenerate);
}

TEST(Arcs, PermutationPermutesTheResult) {
  const std::vector<Sphere> spheres = random_spheres(500, 9, 1, 2, 2);
  std::vector<std::size_t> order(spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  std::vector<Sphere> shuffled;
  for (const std::size_t i : order) shuffled.push_back(spheres[i]);
  const Measured m = measure(spheres), p = measure(shuffled);
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(p.per_sphere[i].area, m.per_sphere[order[i]].area);
    EXPECT_EQ(p.per_sphere[i].volume, m.per_sphere[order[i]].volume);
  }
  EXPECT_REL(p.area, m.area, 1e-15);
  EXPECT_REL(p.volume, m.volume, 1e-15);
}

TEST(Arcs, TranslationRotationAndScaling) {
  const std::vector<Sphere> spheres = random_spheres(500, 9, 1, 2, 4);
  const Measured m = measure(spheres);
  for (const double shift : {1024.0, 1048576.0}) {
    std::vector<Sphere> moved = spheres;
    for (Sphere& s : moved) s.center = s.center + Vec3d{shift, -shift, shift};
    EXPECT_REL(measure(moved).area, m.area, kMotion);
    EXPECT_REL(measure(moved).volume, m.volume, kMotion);
  }
  std::vector<Sphere> turned = spheres;
  for (Sphere& s : turned) s.center = rotated(s.center);
  EXPECT_REL(measure(turned).area, m.area, kMotion);
  EXPECT_REL(measure(turned).volume, m.volume, kMotion);
  for (const double factor : {std::ldexp(1.0, -30), std::ldexp(1.0, 20)}) {
    std::vector<Sphere> scaled = spheres;
    for (Sphere& s : scaled) s = {factor * s.center, factor * s.radius};
    EXPECT_EQ(measure(scaled).area, m.area * factor * factor);
    EXPECT_EQ(measure(scaled).volume, m.volume * factor * factor * factor);
  }
}

TEST(Arcs, AnyNumberOfThreadsGivesTheSameBits) {
  const SphereSet spheres(random_spheres(5000, 25, 1, 2, 5));
  const ArcMeasures free = arc_measures(spheres);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const ArcMeasures alone = arc_measures(spheres);
  EXPECT_EQ(free.suspect, alone.suspect);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    ASSERT_EQ(free.per_sphere[i].area, alone.per_sphere[i].area);
    ASSERT_EQ(free.per_sphere[i].volume, alone.per_sphere[i].volume);
  }
}

// More entries than one block of the sum. The exact sum has an independent mechanism.
TEST(TotalMeasures, AreTheExactSumsForAnyNumberOfThreads) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> exponent(-40, 40);
  std::vector<SphereMeasures> entries(50'000);
  ExactSum area, volume;
  for (SphereMeasures& m : entries) {
    m = {std::exp2(exponent(random)), std::exp2(exponent(random))};
    area.add(m.area);
    volume.add(m.volume);
  }
  const SphereMeasures free = total_measures(entries);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const SphereMeasures alone = total_measures(entries);
  EXPECT_EQ(free.area, alone.area);
  EXPECT_EQ(free.volume, alone.volume);
  EXPECT_DOUBLE_EQ(free.area, area.nearest());
  EXPECT_DOUBLE_EQ(free.volume, volume.nearest());
}

class StopAtOnce : public Monitor {
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

TEST(Arcs, StopsOnRequest) {
  StopAtOnce monitor;
  EXPECT_THROW(arc_measures(SphereSet({{{0, 0, 0}, 1}}), &monitor), Cancelled);
}

}  // namespace
}  // namespace vdwmesh
