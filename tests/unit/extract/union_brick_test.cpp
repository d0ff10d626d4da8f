// One brick of a union of balls on the CPU against the predicate and the exit formula themselves.
#include "extract/union_brick.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include "extract/brick_cases.hpp"
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
          {"beyond float32", {{{1e25, 6, 6}, 1e25}, {{6, 6, 6}, 1.2}}, true},
          {"nodes on spheres", on_nodes},
          {"concentric", {{{6, 6, 6}, 2}, {{6, 6, 6}, 2}, {{6, 6, 6}, 1}}}};
}

Vec3d node(int x, int y, int z) {
  const auto at = [&](int axis, std::int32_t brick, int i) {
    return lattice_coordinate(kGrid, axis, lattice_index(brick, i));
  };
  return {at(0, kMiddle.x, x), at(1, kMiddle.y, y), at(2, kMiddle.z, z)};
}

bool in_union(const std::vector<Sphere>& spheres, const Vec3d& p) {
  for (const Sphere& ball : spheres) {
    if (inside_ball(p, ball)) return true;
  }
  return false;
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

// All balls are asked for every edge, and the normal is that of the owner at the vertex.
TEST_P(UnionBrickTest, VerticesAreTheFirstExits) {
  BrickEdges edges;
  edges.gather(signs_);
  std::size_t put = 0;
  brick_.vertices(edges, [&](std::size_t i, const EdgeVertex& v) {
    ++put;
    const CrossedEdge e = edges.all()[i].crossed();
    const Vec3d inside = node(e.inside[0], e.inside[1], e.inside[2]);
    const CellListView& list = list_.view();
    const EdgePoint exit = first_exit(inside, e.axis, e.direction, kSpacing, [&](auto&& visit) {
      for (std::uint32_t k = 0; k < list.size; ++k) visit(list.spheres[k], list.rank[k], k);
    });
    Vec3d p = inside, outward{0, 0, 0};
    p[e.axis] = std::fma(e.direction, exit.distance, inside[e.axis]);
    outward[e.axis] = e.direction;
    EXPECT_EQ(v.position, p) << case_.name << ", vertex " << i;
    EXPECT_EQ(v.sphere, list.id[exit.owner]) << case_.name << ", vertex " << i;
    EXPECT_EQ(v.clamped, exit.clamped);
    EXPECT_EQ(v.normal, unit_or(p - list.spheres[exit.owner].center, outward));
  });
  EXPECT_EQ(put, edges.all().size());
  EXPECT_EQ(put == 0, case_.hides_brick);
}

// By node, then axis, as row_crossings() and place_in_row() number them.
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
          EXPECT_EQ(first + static_cast<std::size_t>(place_in_row(c, x, axis)), next);
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
