// Properties of the exact union on degenerate input, with and without jitter, and its invariances.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "union_cases.hpp"

namespace vdwmesh {
namespace {

using testing::degenerate_grid;
using testing::jittered;
using testing::unite;

// Relative. The two formula sets share the dual complex and nothing else.
constexpr double kFormulas = 1e-12;
// Relative, by issue 3: coordinates are rounded by the motion.
constexpr double kMotion = 1e-9;

bool same_topology(const UnionTopology& a, const UnionTopology& b) {
  return a.components == b.components && a.tunnels == b.tunnels && a.voids == b.voids &&
         a.euler_characteristic == b.euler_characteristic && a.shells.size() == b.shells.size();
}

std::string describe(const std::vector<Sphere>& spheres) {
  std::string text;
  for (const Sphere& s : spheres) {
    char line[128];
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g %.17g\n", s.center.x, s.center.y,
                  s.center.z, s.radius);
    text += line;
  }
  return text;
}

// Closed balls that meet make one component.
std::uint64_t components_by_pairs(const std::vector<Sphere>& spheres) {
  std::vector<std::size_t> label(spheres.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const double reach = spheres[i].radius + spheres[j].radius;
      if (squared_norm(spheres[i].center - spheres[j].center) > reach * reach) continue;
      const std::size_t from = label[i], to = label[j];
      std::replace(label.begin(), label.end(), from, to);
    }
  }
  std::sort(label.begin(), label.end());
  return static_cast<std::uint64_t>(std::unique(label.begin(), label.end()) - label.begin());
}

void expect_consistent(const ExactUnion& u) {
  EXPECT_RELATIVE(*u.check_area, u.area, kFormulas);
  EXPECT_RELATIVE(*u.check_volume, u.volume, kFormulas);
  double area = 0, volume = 0;
  for (const Shell& s : u.topology->shells) {
    area += s.area;
    volume += s.volume;
  }
  EXPECT_RELATIVE(area, u.area, kFormulas);
  EXPECT_RELATIVE(volume, u.volume, kFormulas);
  EXPECT_RELATIVE(u.topology->outer_area + u.topology->void_area, u.area, kFormulas);
  for (const SphereMeasures& m : u.per_sphere) {
    EXPECT_GE(m.area, -kFormulas * u.area);
    EXPECT_GE(m.volume, -kFormulas * u.volume);
  }
}

TEST(UnionProperties, DegenerateGrids) {
  std::mt19937_64 random(1);
  for (int run = 0; run < 3000 && !HasFailure(); ++run) {
    const auto balls = degenerate_grid(random);
    SCOPED_TRACE(describe(balls));
    const ExactUnion u = unite(balls);
    expect_consistent(u);
    EXPECT_EQ(u.topology->components, components_by_pairs(balls));
  }
}

// Four spheres through one point, of which the last is exposed only beside it: every tetrahedron on
// it merely touches, but one of its triangles does not.
TEST(UnionProperties, ExposedBallWhoseTetrahedraOnlyTouch) {
  const ExactUnion u =
      unite({{{-2, -3, 2}, 3}, {{-1, -3, -1}, 3}, {{1, 1, -1}, 3}, {{0, -2, 1}, 1}});
  expect_consistent(u);
  EXPECT_EQ(u.topology->hidden_spheres, 0u);
  EXPECT_GT(u.per_sphere[3].area, 0.1);
}

// Closed balls have the topology of balls a little larger, in general position.
TEST(UnionProperties, DegenerateGridsHaveTheTopologyOfSlightlyLargerBalls) {
  constexpr double kGrowth = 1e-6, kShift = 1e-10;  // Å; grid features differ by more than 1e-3
  std::mt19937_64 random(2);
  for (int run = 0; run < 3000 && !HasFailure(); ++run) {
    const auto balls = degenerate_grid(random);
    SCOPED_TRACE(describe(balls));
    auto larger = jittered(balls, kShift, random);
    for (Sphere& s : larger) s.radius += kGrowth;
    EXPECT_TRUE(same_topology(*unite(balls).topology, *unite(larger).topology));
  }
}

// How much a cap of ball a's sphere, cut off by ball b, can change when the centres move by `shift`
// (Å) with respect to each other. With the distance d its height changes at a rate of at most
// (1 + |r² - R²| / d²) / 2, and the axis turns by at most asin(shift / d). A cap of height h has
// the area 2 π r h, and the rim of a turning cap sweeps at most 4 r² times the angle.
double cap_change(const Sphere& a, const Sphere& b, double shift) {
  const double r = a.radius, least = norm(b.center - a.center) - shift;
  const double rate = (1 + std::abs(r * r - b.radius * b.radius) / (least * least)) / 2;
  return 2 * std::numbers::pi * r * rate * shift + 4 * r * r * std::asin(shift / (least + shift));
}

// Bound of the change of the union's area when every centre moves by at most `move` (Å): exposed is
// what no cap covers, so the changes of the caps bound it. Of equal balls one counts, and each of
// the others adds a belt; of concentric ones the smaller stays buried.
double area_change(const std::vector<Sphere>& balls, double move) {
  const double shift = 2 * move;
  double bound = 0;
  for (const Sphere& a : balls) {
    for (const Sphere& b : balls) {
      if (&a == &b) continue;
      if (a.center == b.center) {
        if (a.radius == b.radius) bound += 2 * std::numbers::pi * a.radius * shift;
      } else if (norm(b.center - a.center) <= a.radius + b.radius + shift) {
        bound += cap_change(a, b, shift);
      }
    }
  }
  return bound;
}

std::vector<Sphere> grown(std::vector<Sphere> balls, double by) {
  for (Sphere& s : balls) s.radius += by;
  return balls;
}

class Jitter : public ::testing::TestWithParam<double> {};

TEST_P(Jitter, FormulasAgreeAndMeasuresAreContinuous) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 400 && !HasFailure(); ++run) {
    const auto exact = degenerate_grid(random);
    const auto balls = jittered(exact, GetParam(), random);
    SCOPED_TRACE(describe(balls));
    const ExactUnion u = unite(balls), limit = unite(exact);
    expect_consistent(u);
    const double move = std::sqrt(3.0) * GetParam();
    EXPECT_NEAR(u.area, limit.area, area_change(exact, move) + kFormulas * limit.area);
    // A ball that moves by that much lies between two about its old centre.
    const double rounding = kFormulas * limit.volume;
    EXPECT_GE(u.volume, unite(grown(exact, -move)).volume - rounding);
    EXPECT_LE(u.volume, unite(grown(exact, move)).volume + rounding);
  }
}

INSTANTIATE_TEST_SUITE_P(UnionProperties, Jitter,
                         ::testing::Values(1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 1e-5,
                                           1e-4, 1e-3));

TEST(UnionProperties, JitteredLatticesOfCosphericalBalls) {
  std::mt19937_64 random(4);
  // Radius 0.8 of the spacing covers the cells' faces but not their centres, by a margin, while
  // every cell's corners are co-spherical; 0.9 fills the cells, and flat tetrahedra join the
  // complex.
  constexpr double kSpacing = 1.1;  // not a short binary number, so that nothing cancels exactly
  for (const double share : {0.8, 0.9}) {
    const auto lattice = testing::cubic_lattice(4, kSpacing, share * kSpacing);
    const ExactUnion limit = unite(lattice);
    for (const double amplitude : {0.0, 1e-15, 1e-12, 1e-9, 1e-6}) {
      SCOPED_TRACE(amplitude);
      const ExactUnion u = unite(jittered(lattice, amplitude, random));
      expect_consistent(u);
      EXPECT_EQ(u.topology->components, 1u);
      EXPECT_EQ(u.topology->tunnels, 0u);
      EXPECT_EQ(u.topology->voids, share == 0.8 ? 27u : 0u);
      EXPECT_EQ(u.topology->shells.size(), u.topology->voids + 1);
      // A ball ∩ power cell has less than 4π of boundary, which moves by less than 4 amplitudes.
      constexpr double kRounding = 1e-13;  // Å³
      for (std::size_t i = 0; i < lattice.size(); ++i) {
        EXPECT_NEAR(u.per_sphere[i].volume, limit.per_sphere[i].volume,
                    16 * std::numbers::pi * amplitude + kRounding);
      }
    }
  }
}

std::vector<Sphere> cluster(unsigned seed, int count) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, 12), radius(1.2, 1.9);
  std::vector<Sphere> balls(static_cast<std::size_t>(count));
  for (Sphere& s : balls) {
    // Coordinates with 20 binary places, so that a shift by 2^20 is exact.
    const auto coordinate = [&] {
      return std::ldexp(std::round(std::ldexp(place(random), 20)), -20);
    };
    s = {{coordinate(), coordinate(), coordinate()}, radius(random)};
  }
  return balls;
}

TEST(UnionProperties, Translation) {
  const auto balls = cluster(5, 150);
  const ExactUnion u = unite(balls);
  for (const double shift : {1024.0, 0x1p20}) {
    auto moved = balls;
    for (Sphere& s : moved) s.center = s.center + Vec3d{shift, -shift, shift};
    const ExactUnion v = unite(moved);
    EXPECT_RELATIVE(v.area, u.area, kMotion);
    EXPECT_RELATIVE(v.volume, u.volume, kMotion);
    EXPECT_TRUE(same_topology(*v.topology, *u.topology));
    for (std::size_t i = 0; i < balls.size(); ++i) {
      EXPECT_NEAR(v.per_sphere[i].area, u.per_sphere[i].area, kMotion);
      EXPECT_NEAR(v.per_sphere[i].volume, u.per_sphere[i].volume, kMotion);
    }
  }
}

TEST(UnionProperties, ScalingByAPowerOfTwoIsExact) {
  const auto balls = cluster(6, 150);
  const ExactUnion u = unite(balls);
  for (const int exponent : {-30, 20}) {
    auto scaled = balls;
    for (Sphere& s : scaled) {
      s.center = std::ldexp(1.0, exponent) * s.center;
      s.radius = std::ldexp(s.radius, exponent);
    }
    const ExactUnion v = unite(scaled);
    EXPECT_EQ(v.area, std::ldexp(u.area, 2 * exponent));
    EXPECT_EQ(v.volume, std::ldexp(u.volume, 3 * exponent));
    EXPECT_EQ(*v.check_area, std::ldexp(*u.check_area, 2 * exponent));
    EXPECT_EQ(v.topology->void_volume, std::ldexp(u.topology->void_volume, 3 * exponent));
    EXPECT_TRUE(same_topology(*v.topology, *u.topology));
  }
}

TEST(UnionProperties, PermutationIsExact) {
  auto balls = cluster(7, 150);
  const ExactUnion u = unite(balls);
  std::vector<std::size_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937_64(8));
  std::vector<Sphere> permuted;
  for (const std::size_t i : order) permuted.push_back(balls[i]);
  const ExactUnion v = unite(permuted);
  EXPECT_TRUE(same_topology(*v.topology, *u.topology));
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_EQ(v.per_sphere[i].area, u.per_sphere[order[i]].area);
    EXPECT_EQ(v.per_sphere[i].volume, u.per_sphere[order[i]].volume);
  }
}

TEST(UnionProperties, Rotation) {
  const auto balls = cluster(9, 150);
  const ExactUnion u = unite(balls);
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(2.1), e = std::sin(2.1);
  auto turned = balls;
  for (Sphere& b : turned) {
    const Vec3d p{c * b.center.x - s * b.center.y, s * b.center.x + c * b.center.y, b.center.z};
    b.center = {p.x, d * p.y - e * p.z, e * p.y + d * p.z};
  }
  const ExactUnion v = unite(turned);
  EXPECT_RELATIVE(v.area, u.area, kMotion);
  EXPECT_RELATIVE(v.volume, u.volume, kMotion);
  EXPECT_TRUE(same_topology(*v.topology, *u.topology));
}

class StopAtOnce : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

TEST(UnionProperties, StopsOnRequest) {
  StopAtOnce monitor;
  for (const auto method : {UnionMethod::cgal, UnionMethod::arcs, UnionMethod::both}) {
    EXPECT_THROW(exact_union(SphereSet(cluster(10, 100)), {method, &monitor}), Cancelled);
  }
}

TEST(UnionProperties, SumsOverSpheresAreTheTotals) {
  const ExactUnion u = unite(cluster(10, 400));
  double area = 0, volume = 0;
  for (const SphereMeasures& m : u.per_sphere) {
    area += m.area;
    volume += m.volume;
  }
  EXPECT_RELATIVE(area, u.area, 1e-12);
  EXPECT_RELATIVE(volume, u.volume, 1e-12);
}

TEST(UnionProperties, RadiiOfVeryDifferentSize) {
  // A ball of 1e-6 on the surface of one of 1e3: half a small sphere less half a disc, to first
  // order in 1e-9.
  const ExactUnion u = unite({{{0, 0, 0}, 1e3}, {{1e3, 0, 0}, 1e-6}});
  EXPECT_RELATIVE(u.per_sphere[1].area, 2 * std::numbers::pi * 1e-12, 1e-8);
  EXPECT_RELATIVE(*u.check_area, u.area, kFormulas);
}

TEST(UnionProperties, ArcsAndTheReferenceAgree) {
  const auto balls = cluster(12, 300);
  const ExactUnion u = unite(balls), arcs = unite(balls, UnionMethod::arcs),
                   both = unite(balls, UnionMethod::both);
  EXPECT_RELATIVE(arcs.area, u.area, kFormulas);
  EXPECT_RELATIVE(arcs.volume, u.volume, kFormulas);
  EXPECT_FALSE(arcs.topology.has_value());
  EXPECT_EQ(both.area, u.area);
  EXPECT_TRUE(both.topology.has_value());
  EXPECT_RELATIVE(*both.check_area, u.area, kFormulas);
  EXPECT_RELATIVE(*both.check_volume, u.volume, kFormulas);
}

TEST(UnionProperties, SuspectSpheresComeFromTheReference) {
  // Arcs cannot be trusted where eight spheres meet in a point.
  const auto balls = testing::cubic_lattice(3, 1, std::sqrt(0.75));
  const ExactUnion u = unite(balls), arcs = unite(balls, UnionMethod::arcs);
  EXPECT_GT(arcs.fallback_spheres, 0u);
  EXPECT_RELATIVE(arcs.area, u.area, kFormulas);
  EXPECT_RELATIVE(arcs.volume, u.volume, kFormulas);
}

TEST(UnionProperties, TheMethodFollowsWhatIsWanted) {
  const SphereSet balls(cluster(4, 20));
  UnionOptions options;
  EXPECT_EQ(exact_union(balls, options).method, UnionMethod::cgal);
  options.topology = TopologyRequest::none;
  const ExactUnion quick = exact_union(balls, options);
  EXPECT_EQ(quick.method, UnionMethod::arcs);
  EXPECT_FALSE(quick.topology.has_value());
}

// Counts of the whole union do not depend on which spheres are measured.
TEST(UnionProperties, CountsAreThoseOfTheWholeUnion) {
  const SphereSet balls(cluster(4, 20));
  UnionOptions options;
  options.topology = TopologyRequest::counts;
  const ExactUnion all = exact_union(balls, options);
  const std::vector<SphereId> ids{3};
  options.measured = ids;
  const ExactUnion some = exact_union(balls, options);
  ASSERT_TRUE(all.counts && some.counts);
  EXPECT_EQ(some.counts->euler_characteristic, all.counts->euler_characteristic);
  EXPECT_EQ(some.counts->components, all.counts->components);
  EXPECT_EQ(some.area, all.per_sphere[3].area);
  EXPECT_TRUE(std::isnan(some.per_sphere[0].area));
}

// A part of the spheres in the presence of all has the measures that they have among all.
TEST(UnionProperties, MeasuredSpheresHaveTheSameMeasuresAmongAll) {
  const SphereSet balls(cluster(10, 400));
  const std::vector<SphereId> ids{17, 3, 399, 3, 250};  // in any order, one of them twice
  for (const auto method : {UnionMethod::cgal, UnionMethod::arcs, UnionMethod::both}) {
    const ExactUnion all = exact_union(balls, {method, nullptr});
    UnionOptions options{method, nullptr};
    options.measured = ids;
    const ExactUnion some = exact_union(balls, options);
    double area = 0, volume = 0;
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const auto [here_area, here_volume] = some.per_sphere[i];
      if (std::find(ids.begin(), ids.end(), i) == ids.end()) {
        EXPECT_TRUE(std::isnan(here_area) && std::isnan(here_volume)) << i;
        continue;
      }
      EXPECT_EQ(here_area, all.per_sphere[i].area) << i;
      EXPECT_EQ(here_volume, all.per_sphere[i].volume) << i;
      area += here_area;
      volume += here_volume;
    }
    EXPECT_RELATIVE(some.area, area, 1e-14);
    EXPECT_RELATIVE(some.volume, volume, 1e-14);
    EXPECT_RELATIVE(some.check_area.value_or(area), area, kFormulas);
    EXPECT_RELATIVE(some.check_volume.value_or(volume), volume, kFormulas);
  }
}

// Where few spheres are measured the others are left out that cannot cover them. Sets of balls
// unlike proteins: of radii that differ by thousands, apart, nested, touching, on a lattice, far
// from the origin; each ball by itself, and runs of three.
TEST(UnionProperties, SpheresFarFromTheMeasuredOnesDoNotChangeABit) {
  std::vector<std::vector<Sphere>> sets{cluster(30, 300)};
  std::vector<Sphere> uneven, lattice, far;
  for (int i = 0; i < 200; ++i) {
    const double along = 0.9 * i, size = i % 20 == 0 ? 8 : 0.002 + 0.03 * (i % 7);
    uneven.push_back({{along, std::sin(along), std::cos(3 * along)}, size});
  }
  for (int i = 0; i < 125; ++i) {
    lattice.push_back({{2.0 * (i % 5), 2.0 * (i / 5 % 5), 2.0 * (i / 25)}, 1.0});
  }
  for (const Sphere& s : cluster(20, 200))
    far.push_back({s.center + Vec3d{1e6, -1e5, 3e4}, s.radius});
  sets.insert(sets.end(), {uneven, lattice, far});
  UnionOptions options{UnionMethod::arcs, nullptr};
  for (const std::vector<Sphere>& set : sets) {
    const SphereSet balls(set);
    options.measured.reset();
    const ExactUnion all = exact_union(balls, options);
    for (SphereId first = 0; first + 3 <= balls.size(); ++first) {
      std::vector<SphereId> ids{first};
      if (first % 2 == 0) ids.insert(ids.end(), {first + 1, first + 2});
      options.measured = ids;
      const ExactUnion some = exact_union(balls, options);
      for (SphereId id = 0; id < balls.size(); ++id) {
        const bool is_measured = std::ranges::find(ids, id) != ids.end();
        ASSERT_EQ(std::isnan(some.per_sphere[id].area), !is_measured);
        if (!is_measured) continue;
        ASSERT_EQ(some.per_sphere[id].area, all.per_sphere[id].area) << first;
        ASSERT_EQ(some.per_sphere[id].volume, all.per_sphere[id].volume) << first;
      }
    }
  }
}

TEST(UnionProperties, AMeasuredSphereThatDoesNotExistIsRefused) {
  const std::vector<SphereId> ids{0, 20};
  UnionOptions options;
  options.measured = ids;
  EXPECT_THROW(exact_union(SphereSet(cluster(4, 20)), options), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh
