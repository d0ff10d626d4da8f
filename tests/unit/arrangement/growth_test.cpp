// How the work of each stage grows with the set (support/growth.hpp): balls are measured and
// meshed.
#include "support/growth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "creases/exact_mesher.hpp"
#include "measures/exact_union.hpp"
#include "support/ball_families.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

using MakeSet = std::function<std::vector<Sphere>(int)>;

void expect_growth_of(const MakeSet& balls, int count,
                      const std::function<void(const SphereSet&, Monitor&)>& run) {
  expect_growth(count, [&](int n, Monitor& monitor) { run(SphereSet(balls(n)), monitor); });
}

void mesh(const SphereSet& spheres, Monitor& monitor) {
  ExactMeshOptions options;
  options.edge_length = 1;
  options.monitor = &monitor;
  EXPECT_GT(mesh_union(spheres, options).mesh.triangles.size(), 0u);
}

template <UnionMethod kMethod>
void measure(const SphereSet& spheres, Monitor& monitor) {
  UnionOptions options;
  options.method = kMethod;
  options.monitor = &monitor;
  EXPECT_GT(exact_union(spheres, options).area, 0);
}

void expect_growth_of_all(const MakeSet& balls, int count) {
  {
    SCOPED_TRACE("mesh");
    expect_growth_of(balls, count, mesh);
  }
  {
    SCOPED_TRACE("triangulation");
    expect_growth_of(balls, count, measure<UnionMethod::cgal>);
  }
  {
    SCOPED_TRACE("arcs");
    expect_growth_of(balls, count, measure<UnionMethod::arcs>);
  }
}

// Small balls on the sphere of a large one, as dense for every number.
std::vector<Sphere> around_a_large_ball(int count) {
  Dice dice(30);
  const double radius = 1.2 * std::sqrt(count);
  std::vector<Sphere> balls{{{0, 0, 0}, radius}};
  for (int i = 0; i < count; ++i) {
    balls.push_back({radius * random_direction(dice), dice.real(1, 1.5)});
  }
  return balls;
}

TEST(Growth, SmallBallsOnALargeOne) { expect_growth_of_all(around_a_large_ball, 1000); }

// Small balls that stand apart on a large one, so that its patch has whole circles alone.
TEST(Growth, CirclesOnALargeBall) {
  const auto balls = [](int count) {
    const double radius = 3 * std::sqrt(count);
    std::vector<Sphere> out{{{0, 0, 0}, radius}};
    for (int i = 0; i < count; ++i) {
      constexpr double kGoldenAngle = 2.399963229728653;
      const double z = 1 - (2 * i + 1.0) / count, wide = std::sqrt(1 - z * z);
      out.push_back(
          {radius * Vec3d{wide * std::cos(kGoldenAngle * i), wide * std::sin(kGoldenAngle * i), z},
           1});
    }
    return out;
  };
  expect_growth_of_all(balls, 1000);
}

// Ever more copies of the same atoms, each moved a little.
TEST(Growth, JitteredCopies) {
  const auto balls = [](int count) {
    Dice dice(32);
    constexpr int kAtoms = 20;
    std::vector<Sphere> atoms, out;
    for (int i = 0; i < kAtoms; ++i) {
      atoms.push_back({{dice.real(0, 5), dice.real(0, 5), dice.real(0, 5)}, dice.real(1.5, 1.9)});
    }
    for (int i = 0; i < count; ++i) {
      const Sphere& s = atoms[static_cast<std::size_t>(i % kAtoms)];
      out.push_back({s.center + dice.real(0, 0.3) * random_direction(dice), s.radius});
    }
    return out;
  };
  // Measures by arcs cut every ball by all that overlap it.
  expect_growth_of(balls, 8000, mesh);
  expect_growth_of(balls, 8000, measure<UnionMethod::cgal>);
}

// Balls that touch their neighbours on two skew lines: the triangulation of n balls has about n²/4
// cells, so n²/4 is what all may grow with.
TEST(Growth, BallsOnSkewLines) {
  const auto balls = [](int count) {
    std::vector<Sphere> out;
    const int half = static_cast<int>(std::sqrt(count));
    for (int i = 0; i < half; ++i) {
      out.push_back({{2.0 * i - half, 0, 0}, 1});
      out.push_back({{0.37, 2.0 * i - half + 0.21, 2.5}, 1});
    }
    return out;
  };
  SCOPED_TRACE("triangulation");
  expect_growth_of(balls, 20000, measure<UnionMethod::cgal>);
}

// The memory for so many cells is refused before it is taken.
TEST(Growth, CellsOfSkewLinesKeepTheMemoryLimit) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 1000; ++i) {
    balls.push_back({{2.0 * i - 1000, 0, 0}, 1});
    balls.push_back({{0.37, 2.0 * i - 1000 + 0.21, 2.5}, 1});
  }
  UnionOptions options;
  options.method = UnionMethod::cgal;
  options.memory_limit = 20'000'000;
  EXPECT_THROW(exact_union(SphereSet(std::move(balls)), options), LimitExceeded);
}

// Shells of balls with a void in each.
TEST(Growth, ManyVoids) {
  const auto balls = [](int count) {
    std::vector<Sphere> out;
    const int side = static_cast<int>(std::lround(std::cbrt(count)));
    for (int i = 0; i < side * side * side; ++i) {
      const Vec3d at{6.0 * (i % side), 6.0 * (i / side % side), 6.0 * (i / side / side)};
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          Vec3d center = at;
          center[axis] += 1.6 * sign;
          out.push_back({center, 1.58 + 1e-3 * axis});
        }
      }
      for (int corner = 0; corner < 8; ++corner) {
        const auto of = [&](int bit) { return (corner >> bit) % 2 == 0 ? -1.3 : 1.3; };
        out.push_back({at + Vec3d{of(0), of(1), of(2)}, 1.4});
      }
    }
    return out;
  };
  expect_growth_of_all(balls, 125);
}

// Chains of balls, of which each one overlaps the next.
TEST(Growth, ManyChains) {
  const auto balls = [](int count) {
    Dice dice(7);
    std::vector<Sphere> out;
    constexpr int kLength = 20;
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int chain = 0; chain < count; ++chain) {
      for (int i = 0; i < kLength; ++i) {
        out.push_back({{5.0 * (chain % side) + dice.real(0, 0.2),
                        5.0 * (chain / side) + dice.real(0, 0.2), 1.5 * i},
                       1 + dice.real(0, 0.2)});
      }
    }
    return out;
  };
  expect_growth_of_all(balls, 100);
}

}  // namespace
}  // namespace vdwmesh::testing
