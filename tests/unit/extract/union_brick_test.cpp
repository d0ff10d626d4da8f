// One brick of a union of balls on the CPU against the definition of the union, in long double.
#include "extract/union/union_brick.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "extract/bricks/brick_cases.hpp"
#include "extract/grid.hpp"

namespace vdwmesh {
namespace {

constexpr double kSpacing = 0.5;  // Å
const GridSpec kGrid{{0, 0, 0}, kSpacing, {24, 24, 24}};
const BrickIndex kMiddle{1, 1, 1};  // all its nodes belong to the grid

struct Case {
  const char* name;
  std::vector<Sphere> spheres;
  bool hides_brick = false;  // all of its nodes are inside
};

// Balls around the brick's box, some of them far too large or too small for it.
std::vector<Sphere> random_balls(std::size_t count, double least, double most, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(1, 11), radius(least, most);
  std::vector<Sphere> spheres(count);
  for (Sphere& s : spheres) s = {{place(random), place(random), place(random)}, radius(random)};
  return spheres;
}

std::vector<Case> cases() {
  // Centres on nodes and radii of whole spacings: many nodes lie exactly on a sphere.
  std::vector<Sphere> on_nodes;
  for (int i = 0; i < 6; ++i) on_nodes.push_back({{4.0 + i, 5.5, 6.0}, 1.5});
  return {{"one", {{{5.9, 6.1, 6.0}, 1.7}}},
          {"few", random_balls(12, 1.1, 1.9, 1)},
          {"more than a word of bits", random_balls(400, 0.4, 0.8, 2)},
          {"more than two words", random_balls(1500, 0.25, 0.5, 3)},
          {"giant", {{{1e6, 6, 6}, 1e6 - 5.7}, {{6, 6, 6}, 1.2}}},
          {"as large as they get", {{{1e6, 6, 6}, 1e6}, {{6, 6, 6}, 1.2}}, true},
          {"nodes on spheres", on_nodes},
          {"concentric", {{{6, 6, 6}, 2}, {{6, 6, 6}, 2}, {{6, 6, 6}, 1}}}};
}

Vec3d node(int x, int y, int z) {
  const auto at = [&](int axis, std::int32_t brick, int i) {
    return lattice_coordinate(kGrid, axis, lattice_index(brick, i));
  };
  return {at(0, kMiddle.x, x), at(1, kMiddle.y, y), at(2, kMiddle.z, z)};
}

// d^2 - r^2 in 64 binary digits. The cases put nodes exactly on spheres, where this is exactly 0,
// or farther off than the 53 digits of the code under test could mistake.
long double beyond(const Sphere& ball, const Vec3d& p) {
  long double sum = -static_cast<long double>(ball.radius) * ball.radius;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = static_cast<long double>(p[axis]) - ball.center[axis];
    sum += d * d;
  }
  return sum;
}

bool in_union(const std::vector<Sphere>& spheres, const Vec3d& p) {
  return std::ranges::any_of(spheres, [&](const Sphere& ball) { return beyond(ball, p) <= 0; });
}

// How far one can go from p along the axis (direction 1 or -1) inside the union: the intervals in
// which balls hold the line are joined from p on.
long double covered_from(const std::vector<Sphere>& spheres, const Vec3d& p, int axis,
                         double direction) {
  struct Interval {
    long double enter, exit;
  };
  std::vector<Interval> intervals;
  for (const Sphere& ball : spheres) {
    const long double along = direction * (static_cast<long double>(ball.center[axis]) - p[axis]);
    const long double half2 = along * along - beyond(ball, p);
    if (half2 >= 0) intervals.push_back({along - std::sqrt(half2), along + std::sqrt(half2)});
  }
  std::ranges::sort(intervals, {}, &Interval::enter);
  long double end = 0;
  for (const Interval& i : intervals) {
    if (i.enter <= end) end = std::max(end, i.exit);
  }
  return end;
}

class UnionBrickTest : public testing::TestWithParam<std::size_t> {
 protected:
  UnionBrickTest()
      : case_(cases()[GetParam()]),
        set_(case_.spheres),
        list_(make_ball_list(set_)),
        model_(make_field_model({}, kGrid)),
        brick_(list_.view(), model_) {
    brick_.visit(kMiddle);
    brick_.signs(signs_);
  }
  Case case_;
  SphereSet set_;
  CellList list_;
  FieldModel model_;
  UnionBrick brick_;
  BrickSigns signs_{};
};

TEST_P(UnionBrickTest, SignsAreThoseOfThePredicate) {
  for (int z = 0; z < kBrickReach; ++z) {
    for (int y = 0; y < kBrickReach; ++y) {
      for (int x = 0; x < kBrickReach; ++x) {
        EXPECT_EQ((signs_.row[z][y] >> x & 1) != 0, in_union(case_.spheres, node(x, y, z)))
            << case_.name << ", node " << x << ' ' << y << ' ' << z;
      }
    }
  }
}

// The giant's interval is the difference of numbers of 1e6 Å, whose squares are good to 1e-4 Å^2.
constexpr double kExitTolerance = 1e-9;           // Å
constexpr double kNormalTolerance = 3e-7;         // of a float32 unit vector
constexpr double kClampedPart = 1.0 / (1 << 20);  // of an edge, from either end

TEST_P(UnionBrickTest, VerticesAreTheFirstExits) {
  BrickEdges edges;
  edges.gather(signs_);
  std::size_t put = 0;
  brick_.vertices(edges, [&](std::size_t i, const EdgeVertex& v) {
    ++put;
    const CrossedEdge e = edges.all()[i].crossed();
    const Vec3d inside = node(e.inside[0], e.inside[1], e.inside[2]);
    const auto exit = static_cast<double>(covered_from(case_.spheres, inside, e.axis, e.direction));
    const double least = kClampedPart * kSpacing, most = kSpacing - least;
    const double distance = std::clamp(exit, least, most);
    Vec3d p = inside;
    p[e.axis] += e.direction * distance;
    EXPECT_LE(norm(v.position - p), kExitTolerance) << case_.name << ", vertex " << i;
    EXPECT_EQ(v.clamped, distance != exit) << case_.name << ", vertex " << i;
    ASSERT_LT(v.sphere, case_.spheres.size());
    const Sphere& owner = case_.spheres[v.sphere];
    const Vec3d from = v.position - owner.center;
    const double off = v.clamped ? least : 0;
    EXPECT_NEAR(norm(from), owner.radius, off + kExitTolerance) << case_.name << ", vertex " << i;
    EXPECT_LE(norm(cast<double>(v.normal) - (1 / norm(from)) * from), kNormalTolerance);
  });
  EXPECT_EQ(put, edges.all().size());
  EXPECT_EQ(put == 0, case_.hides_brick);
}

// By node, then axis, as row_crossings() and crossings_before() number them.
TEST_P(UnionBrickTest, EdgesStandInTheOrderOfTheirVertices) {
  BrickEdges edges;
  edges.gather(signs_);
  std::size_t next = 0, along = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      const RowCrossings c = row_crossings(signs_, y, z);
      const std::size_t first = next;
      for (int x = 0; x < kBrickSide; ++x) {
        for (int axis = 0; axis < 3; ++axis) {
          if (!c.has(x, axis)) continue;
          ASSERT_LT(next, edges.all().size());
          const BrickEdge e = edges.all()[next];
          EXPECT_EQ(
              first + static_cast<std::size_t>(count_bits(c.packed & crossings_before(x, axis))),
              next);
          EXPECT_TRUE(e.x() == x && e.y() == y && e.z() == z && e.axis() == axis);
          EXPECT_EQ(e.lower_inside(), (signs_.row[z][y] >> x & 1) != 0);
          ++next;
        }
      }
    }
  }
  EXPECT_EQ(next, edges.all().size());
  for (const std::uint16_t i : edges.along<0>()) along += edges.all()[i].axis() == 0;
  for (const std::uint16_t i : edges.along<1>()) along += edges.all()[i].axis() == 1;
  for (const std::uint16_t i : edges.along<2>()) along += edges.all()[i].axis() == 2;
  EXPECT_EQ(along, edges.all().size());
  EXPECT_EQ(edges.along<0>().size() + edges.along<1>().size() + edges.along<2>().size(), along);
}

TEST_P(UnionBrickTest, CasesAreThoseOfTheCells) {
  BrickCases cases;
  cases.set(signs_);
  std::vector<std::array<int, 4>> expected, visited;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      for (int x = 0; x < kBrickSide; ++x) {
        const auto inside = static_cast<int>(cell_case(signs_, x, y, z));
        EXPECT_EQ(static_cast<int>(cases.at(x, y, z)), inside);
        if (inside != 0 && inside != 255) expected.push_back({x, y, z, inside});
      }
    }
  }
  cases.for_each_mixed([&](int x, int y, int z, std::uint32_t inside) {
    visited.push_back({x, y, z, static_cast<int>(inside)});
  });
  EXPECT_EQ(visited, expected);
}

INSTANTIATE_TEST_SUITE_P(Balls, UnionBrickTest, testing::Range(std::size_t{0}, cases().size()));

}  // namespace
}  // namespace vdwmesh
