// Sets that break programs: nothing, coincident, nested, tangent, cospherical, lattices, jitter,
// extreme sizes and places, and options that make no sense.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <string>

#include "contract/exact_mesher_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "support/dice.hpp"
#include "unit/arrangement/union_cases.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherAwkward : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherAwkward);

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Arcs up to kNoArc of the radius may be left out, and circles up to kNoCircle, beside which
// the spheres are within its square: 1e-8 and 1e-12 of radii up to 2 Å, with some room for
// what a collapse moves.
constexpr double kCollapsed = 1e-7;  // Å

Demands collapsed(Topology topology = Topology::exact) {
  Demands demands;
  demands.distance = kCollapsed;
  demands.topology = topology;
  return demands;
}

void expect_set(std::vector<Sphere> spheres, double edge_length = 0.5, const Demands& demands = {},
                int levels = 1) {
  expect_union_meshes(SphereSet(std::move(spheres)), edge_length, levels, demands);
}

TEST_P(ExactMesherAwkward, NoSpheres) { EXPECT_THROW(mesh_at(SphereSet(), 0.5), InvalidInput); }

TEST_P(ExactMesherAwkward, EdgeLengthsThatAreNone) {
  for (const double h : {0.0, -0.0, -0.35, std::nan(""), kInfinity, -kInfinity}) {
    EXPECT_THROW(mesh_at(one_sphere(1), h), InvalidInput) << h;
  }
}

TEST_P(ExactMesherAwkward, EdgeLengthsFromTinyToHuge) {
  for (const double h : {0.02, 0.1, 1.0, 3.0, 10.0, 1e3, 1e300}) {
    SCOPED_TRACE(h);
    expect_set({{{0, 0, 0}, 1}}, h);
    expect_set({{{0, 0, 0}, 1}, {{1.2, 0.3, 0.4}, 0.9}}, h);
  }
  for (const double h : {2.0, 10.0, 1e9}) {
    SCOPED_TRACE(h);
    expect_union_meshes(cluster(50, 2), h, 2);
    expect_union_meshes(hollow_shell(100, 5, 1.2), h, 1);
  }
}

TEST_P(ExactMesherAwkward, TooFineIsRefusedBeforeMemoryIsTaken) {
  EXPECT_THROW(mesh_at(one_sphere(1), 1e-6), LimitExceeded);
  EXPECT_THROW(mesh_at(one_sphere(1), 1e-300), LimitExceeded);
  ExactMeshOptions options;
  options.memory_limit = 1000;
  EXPECT_THROW(mesh_with(one_sphere(1), options), LimitExceeded);
  // Patches are there beside the mesh they become: 12 bytes a triangle and 24 a vertex more.
  options.edge_length = 0.05;
  options.memory_limit = kNoMemoryLimit;
  const IndexedMesh mesh = mesh_with(one_sphere(1), options).mesh;
  options.memory_limit =
      indexed_mesh_bytes(mesh) + 12 * mesh.triangle_count() + 24 * mesh.vertex_count();
  EXPECT_THROW(mesh_with(one_sphere(1), options), LimitExceeded);
}

class StopAtOnce : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return true; }
};

// Spheres through a point or a circle, shaken: several sets of feature sizes are tried in turn, and
// curves are split again and again. Whatever the limit, there is the same mesh or none.
TEST_P(ExactMesherAwkward, LessMemoryIsNeverAnotherMesh) {
  Dice dice(34);
  const auto shaken = [&](std::vector<Sphere> spheres, double by) {
    for (Sphere& s : spheres) {
      s.center = s.center + Vec3d{dice.real(-by, by), dice.real(-by, by), dice.real(-by, by)};
    }
    return SphereSet(spheres);
  };
  std::vector<Sphere> ring, pencil;
  for (int i = 0; i < 6; ++i) {
    const double turn = i * std::numbers::pi / 3, height = 0.4 * i - 1;
    ring.push_back({{std::cos(turn), std::sin(turn), 0}, 1});
    pencil.push_back({{0, 0, height}, std::hypot(1.0, height)});
  }
  int meshes = 0, refused = 0;
  for (const double by : {1e-16, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5}) {
    for (const SphereSet& set : {shaken(ring, by), shaken(pencil, by)}) {
      const auto outcome = [&](std::uint64_t limit) -> std::optional<IndexedMeshHash> {
        ExactMeshOptions options;
        options.edge_length = 0.3;
        options.memory_limit = limit;
        try {
          return hash(mesh_with(set, options).mesh);
        } catch (const LimitExceeded&) {
          return std::nullopt;
        }
      };
      const auto best = outcome(kNoMemoryLimit);
      for (std::uint64_t limit = std::uint64_t{1} << 15; limit < std::uint64_t{1} << 26;
           limit *= 2) {
        const auto found = outcome(limit);
        if (found) {
          EXPECT_EQ(found, best) << by << " with " << limit << " bytes";
        }
        found ? ++meshes : ++refused;
      }
    }
  }
  EXPECT_GT(meshes, 0);
  EXPECT_GT(refused, 0);
}

TEST_P(ExactMesherAwkward, StopsWhenAsked) {
  StopAtOnce monitor;
  ExactMeshOptions options;
  options.monitor = &monitor;
  EXPECT_THROW(mesh_with(cluster(100, 1), options), Cancelled);
}

TEST_P(ExactMesherAwkward, Coincident) {
  expect_set({{{1, 2, 3}, 1.5}, {{1, 2, 3}, 1.5}});
  expect_set({{{1, 2, 3}, 1.5}, {{2, 2, 3}, 1.5}, {{1, 2, 3}, 1.5}, {{2, 2, 3}, 1.5}});
}

TEST_P(ExactMesherAwkward, NestedAndConcentric) {
  expect_set({{{0, 0, 0}, 1}, {{0, 0, 0}, 2}});
  expect_set({{{0.2, 0.1, 0}, 1}, {{0, 0, 0}, 2}, {{3, 0, 0}, 1.5}});
}

TEST_P(ExactMesherAwkward, TangentOutside) {
  expect_set({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}});
  expect_set({{{0, 0, 0}, 1}, {{3, 0, 0}, 2}, {{3, 2.5, 0}, 0.5}});
  std::vector<Sphere> chain;
  for (int i = 0; i < 8; ++i) chain.push_back({{2.0 * i, 0, 0}, 1});
  expect_set(chain);
}

TEST_P(ExactMesherAwkward, TangentInside) {
  expect_set({{{0, 0, 0}, 2}, {{1, 0, 0}, 1}});
  expect_set({{{0, 0, 0}, 2}, {{1, 0, 0}, 1}, {{-1, 0, 0}, 1}, {{0, 1.5, 0}, 0.5}});
  expect_set({{{0, 0, 0}, 2}, {{1, 0, 0}, 1}, {{2, 0, 0}, 1}});
}

// Two balls touch, and a third stands on their contact: what is left of it is a band that is
// narrower than the chords of its two circles bulge.
TEST_P(ExactMesherAwkward, ATinyBallOnAContact) {
  for (const int exponent : {-6, -10, -12, -14, -18}) {
    SCOPED_TRACE(exponent);
    expect_set({{{0, 0, 0}, 1.5}, {{2.1, 2.8, 0}, 2}, {{0.9, 1.2, 0}, std::ldexp(1.0, exponent)}});
  }
}

std::string refusal(const SphereSet& spheres, double edge_length) {
  try {
    mesh_at(spheres, edge_length);
  } catch (const LimitExceeded& error) {
    return error.what();
  }
  return "";
}

// A ball that all but touches two others, which are one but for 7e-11 Å; with long edges there are
// no lattice points on any of them.
TEST_P(ExactMesherAwkward, ATwinOnAContact) {
  const double x = -3.9901123046875, z = -3.125732421875;
  for (const double edge_length : {0.5, 1.6, 10.0}) {
    SCOPED_TRACE(edge_length);
    expect_set({{{x, 2.5001220703125, z}, 1.0068959960937498},
                {{x, 0.4932260742187502, z}, 1},
                {{x, 0.49322607421965969, z}, 1}},
               edge_length, collapsed(Topology::parted));
  }
}

// Where a ball reaches as far as another's contact, the middle of two points on one circle lies in
// the other ball, at the pole of the projection or beyond it.
TEST_P(ExactMesherAwkward, ALargePatchWithLongEdges) {
  for (const double edge_length : {0.5, 1.0, 3.0, 100.0}) {
    SCOPED_TRACE(edge_length);
    expect_set({{{0, 0, 0}, 0.5}, {{0, -0.5, 0}, 0.5}, {{0, 1.5, 0}, 1}}, edge_length);
    expect_set({{{0, 0, 0}, 0.5}, {{0, -0.5, 0}, 0.5}, {{0.375, 0, 0}, 0.25}}, edge_length);
  }
}

// Beside a cap of 2e-10 rad one of 2e-8, which counts as a contact and has no arc: a patch goes
// across it. Turned about, the set has other roundings.
TEST_P(ExactMesherAwkward, ATinyCapBesideAContact) {
  const double small = std::ldexp(1.0, -13);
  for (const std::array<int, 3>& axes : std::vector<std::array<int, 3>>{
           {0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    for (const double sign : {1.0, -1.0}) {
      const auto on_axis = [&](int axis, double distance) {
        Vec3d c{0, 0, 0};
        c[axes[static_cast<std::size_t>(axis)]] = sign * distance;
        return c;
      };
      for (const double edge_length : {0.35, 1.0}) {
        SCOPED_TRACE(edge_length);
        expect_set({{{0, 0, 0}, 1.5},
                    {on_axis(0, std::nextafter(1.5 + small, 0)), small},
                    {on_axis(1, std::nextafter(2, 0)), 0.5}},
                   edge_length, collapsed(Topology::parted), 0);
      }
    }
  }
}

// A ball and its twin a hair beside it: no double lies between their circles.
TEST_P(ExactMesherAwkward, CurvesThatAllButCoincideAreMadeOne) {
  Demands demands = collapsed(Topology::parted);
  demands.distance = 1e-6;  // Å: features of 1e-7 of the radius had to go
  expect_set({{{3.9991455078125, -2.913818359375, -4}, 0.1075185546875},
              {{-1, -0.5, 2.5}, 2.5},
              {{3.9991455078125, -1.5213369140624999, -4}, 1.5},
              {{3.9991455078127274, -2.913818359375, -4}, 0.1075185546875}},
             1.0, demands, 0);
}

// Four spheres through one circle, shaken by 1e-14: strips of no width between crossing curves.
TEST_P(ExactMesherAwkward, CurvesThatCrossInStripsAreRefused) {
  EXPECT_THAT(
      refusal(SphereSet({{{-7.3127151177519763e-15, 6.9486747387446534e-15, -0.99999999999999467},
                          1.4142135623730951},
                         {{-4.8986194852115662e-15, -9.1298258161180975e-17, -0.33333333333333437},
                          1.0540925533894598},
                         {{3.0318594544552592e-15, 5.7744670227102633e-15, 0.33333333333332515},
                          1.0540925533894598},
                         {{-9.4330504695598744e-15, 6.7153020783973941e-15, 0.99999999999999867},
                          1.4142135623730951}}),
              0.3),
      HasSubstr("all but coincide"));
}

// Three balls, two by two tangent: three contacts, and a ring parted into three.
TEST_P(ExactMesherAwkward, RingOfContacts) {
  const double h = std::sqrt(3.0);
  expect_set({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{1, h, 0}, 1}}, 0.5, collapsed(Topology::parted));
  expect_set({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{2, 2, 0}, 1}, {{0, 2, 0}, 1}});
}

// Circles of 1e-7 … 1e-2 Å between balls that all but touch.
TEST_P(ExactMesherAwkward, NearlyTangent) {
  for (const double overlap : {1e-15, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4}) {
    SCOPED_TRACE(overlap);
    const Demands demands = overlap < 1e-11 ? collapsed(Topology::parted) : Demands{};
    expect_set({{{0, 0, 0}, 1}, {{2 - overlap, 0, 0}, 1}}, 0.5, demands);
    expect_set({{{0.1, 0.2, 0.3}, 1.7}, {{0.1, 0.2 + 0.2 + overlap, 0.3}, 1.5}}, 0.5, demands);
  }
}

// A third ball reaches into the crease of two by little, or just not.
TEST_P(ExactMesherAwkward, ABallThatAllButTouchesACircle) {
  // Balls of 5 at (±4, 0, 0) have the circle x = 0 of radius 3.
  for (const double reach : {-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6, 1e-3}) {
    SCOPED_TRACE(reach);
    const bool near = std::abs(reach) < 1e-6;
    const Demands demands = near ? collapsed(Topology::parted) : Demands{};
    expect_set({{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}, {{0, 0, 4 - reach}, 1}}, 1, demands);
    // The same from within: a ball that all but fills its place in the crease.
    expect_set({{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}, {{0, 0, 2 + reach}, 1}}, 1, demands);
  }
}

// Spheres that share one circle: the middle one is exposed nowhere else.
TEST_P(ExactMesherAwkward, SpheresThroughOneCircle) {
  expect_set({{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}, {{0, 0, 0}, 3}}, 1, collapsed());
  expect_set({{{-4, 0, 0}, 5}, {{0, 0, 0}, 3}, {{0, 0, 0}, 3}, {{4, 0, 0}, 5}}, 1, collapsed());
  for (const double off : {1e-14, 1e-12, 1e-9, 0.1}) {
    SCOPED_TRACE(off);
    expect_set({{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}, {{0, 0, 0}, 3 + off}}, 1, collapsed());
    expect_set({{{-4, 0, 0}, 5}, {{4, 0, 0}, 5}, {{off, 0, 0}, 3}}, 1, collapsed());
  }
}

// (±a, ±b, 0) of 1, 2 and radius 3: four or eight spheres through (0, 0, ±2).
TEST_P(ExactMesherAwkward, ManySpheresThroughOnePoint) {
  std::vector<Sphere> four, eight;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-1.0, 1.0}) {
      four.push_back({{s, 2 * t, 0}, 3});
      eight.push_back({{s, 2 * t, 0}, 3});
      eight.push_back({{2 * s, t, 0}, 3});
    }
  }
  expect_set(four, 1, collapsed(), 2);
  expect_set(eight, 1, collapsed(), 2);
}

// Corners of a cube, radius where 2 (tangent), 4 (a face's middle) and 8 (the cube's) meet.
TEST_P(ExactMesherAwkward, CubesWhoseSpheresMeetInPoints) {
  for (const double radius : {1.0, std::sqrt(2.0), std::sqrt(3.0)}) {
    for (const double off : {-1e-3, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-3}) {
      SCOPED_TRACE(std::to_string(radius) + " + " + std::to_string(off));
      const bool clear = std::abs(off) >= 1e-3;
      expect_set(cubic_lattice(2, 2, radius + off), 0.6,
                 clear ? Demands{} : collapsed(Topology::parted));
    }
  }
}

TEST_P(ExactMesherAwkward, Lattices) {
  expect_set(cubic_lattice(3, 2, 1.25), 0.6, collapsed());
  expect_set(cubic_lattice(3, 2, 1.5), 0.6, collapsed());
  expect_set(cubic_lattice(3, 1, 1.0), 0.4, collapsed());
  std::vector<Sphere> fcc;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < 4; ++k) {
        if ((i + j + k) % 2 == 0) fcc.push_back({{1.0 * i, 1.0 * j, 1.0 * k}, 0});
      }
    }
  }
  for (const double radius : {0.72, 0.75, 0.9, 1.0, 1.25, std::sqrt(1.5)}) {
    SCOPED_TRACE(radius);
    for (Sphere& s : fcc) s.radius = radius;
    expect_set(fcc, 0.4, collapsed(radius == 1.0 ? Topology::parted : Topology::exact));
  }
}

// Two balls shallow in a third: their circles on it are `gap` (rad) apart at the nearest, and the
// two balls nearer still at no other place.
std::vector<Sphere> two_lids(double gap) {
  constexpr double kHalfAngle = 0.5, kHeight = 1;
  const double turn = kHalfAngle + gap / 2;
  const Vec3d left{-std::sin(turn), 0, std::cos(turn)}, right{std::sin(turn), 0, std::cos(turn)};
  const double r = std::hypot(2 * std::sin(kHalfAngle), 2 * std::cos(kHalfAngle) - kHeight);
  return {{{0, 0, 0}, 2}, {kHeight * left, r}, {kHeight * right, r}};
}

TEST_P(ExactMesherAwkward, CirclesOfOneBallThatAllButTouch) {
  for (const double gap : {-1e-4, -1e-9, -1e-14, 0.0, 1e-16, 1e-14, 1e-12, 1e-10, 1e-9, 1e-4}) {
    SCOPED_TRACE(gap);
    const bool clear = std::abs(gap) >= 1e-4;
    expect_set(two_lids(gap), 0.5, clear ? Demands{} : collapsed(Topology::exact));
  }
}

// Balls that overlap by 1e-12 have circles of 1e-6, which are made points up to kNoCircle. Circles
// of one ball touch at a radius of √2.
TEST_P(ExactMesherAwkward, JitteredLattices) {
  std::mt19937_64 random(5);
  Demands demands = collapsed(Topology::parted);
  demands.distance = 4e-6;  // Å
  for (const double jitter : {1e-15, 1e-14, 1e-12, 1e-10, 1e-9, 1e-8, 2e-8, 1e-6}) {
    for (const double radius : {1.0, 1.25, std::sqrt(2.0)}) {
      SCOPED_TRACE(std::to_string(radius) + " jitter " + std::to_string(1e9 * jitter) + "e-9");
      expect_set(jittered(cubic_lattice(3, 2, radius), jitter, random), 0.6, demands);
    }
  }
}

TEST_P(ExactMesherAwkward, Cages) {
  expect_set(buckminsterfullerene(1.4, 1.7), 0.5, collapsed());
  expect_set(buckminsterfullerene(1.4, 0.8), 0.4, collapsed());
  std::mt19937_64 random(6);
  expect_set(jittered(buckminsterfullerene(1.4, 1.7), 1e-9, random), 0.5, collapsed());
}

// Balls centred on a sphere through one point, all of the same radius: all pass through it.
TEST_P(ExactMesherAwkward, Cospherical) {
  std::vector<Sphere> balls;
  for (const Vec3d& d : octahedron_corners()) balls.push_back({2.0 * d, 2});
  expect_set(balls, 0.6, collapsed(Topology::parted));
  for (Sphere& b : balls) b.radius = 2.5;
  expect_set(balls, 0.6, collapsed());
}

TEST_P(ExactMesherAwkward, SmallSetsOnAGridOfIntegers) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 250; ++i) {
    SCOPED_TRACE(i);
    Demands demands = collapsed(Topology::parted);
    expect_set(degenerate_grid(random), 1.0, demands);
  }
}

TEST_P(ExactMesherAwkward, RadiiFarApart) {
  for (const double ratio : {1e-3, 1e3}) {
    SCOPED_TRACE(ratio);
    expect_set({{{0, 0, 0}, 1}, {{1, 0, 0}, ratio}}, 0.2 * std::max(1.0, ratio));
    expect_set({{{0, 0, 0}, 1}, {{1 + 0.5 * ratio, 0, 0}, ratio}}, 0.2 * std::max(1.0, ratio));
    expect_set({{{0, 0, 0}, 1}, {{ratio + 0.9, 0, 0}, ratio}, {{ratio + 0.3, 0.8, 0.4}, ratio}},
               0.2 * std::max(1.0, ratio), [] {
                 Demands demands;
                 demands.distance = 1e-9 * 1e3;  // Å: relative to the largest radius
                 return demands;
               }());
  }
}

TEST_P(ExactMesherAwkward, FarFromTheOrigin) {
  expect_union_meshes(translated(cluster(40, 9), {1e4, -1e4, 1e4}), 0.5, 2);
  // At 1e6 Å a coordinate is rounded to 1e-10 Å.
  Demands demands;
  demands.distance = 1e-8;
  expect_union_meshes(translated(cluster(40, 9), {1e6, -1e6, 1e6}), 0.5, 1, demands);
}

TEST_P(ExactMesherAwkward, ManyBallsAlongALine) {
  std::vector<Sphere> line;
  for (int i = 0; i < 60; ++i) line.push_back({{0.3 * i, 0, 0}, 1.5});
  expect_set(line, 0.5);
}

// A ball almost covered by many: patches like needles, and slits between them.
TEST_P(ExactMesherAwkward, SliversBetweenManyCircles) {
  for (const double radius : {1.04, 1.06, 1.08, 1.1}) {
    SCOPED_TRACE(radius);
    std::vector<Sphere> balls = {{{0, 0, 0}, radius}};
    for (int i = 0; i < 12; ++i) {
      const double a = 2 * std::numbers::pi * i / 12;
      balls.push_back({{std::cos(a), std::sin(a), 0.01 * (i % 3)}, 1});
    }
    expect_set(balls, 0.4);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
