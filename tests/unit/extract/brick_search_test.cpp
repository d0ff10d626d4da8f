// Whatever the extractor leaves out, against the same meshes without it: bricks that the search
// drops, spheres that are not near, float32 where double decides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "extract/blended/field_formulas.hpp"
#include "extract/union/union_brick.hpp"
#include "support/dice.hpp"
#include "support/plain_extractor.hpp"
#include "support/sanitized.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;

constexpr FieldKind kFields[] = {FieldKind::vdw, FieldKind::blinn, FieldKind::soft_object,
                                 FieldKind::inverse_squared};

ExtractOptions at_spacing(FieldKind kind, double spacing) {
  ExtractOptions options;
  options.field.kind = kind;
  options.grid.spacing = spacing;
  options.connectivity = Connectivity::half_edges;
  return options;
}

// All arrays are those of all bricks.
void expect_none_lost(const SphereSet& spheres, const ExtractOptions& options,
                      const std::string& what) {
  const ExtractResult found = make_cpu_extractor()->extract(spheres, options);
  EXPECT_GT(found.mesh.triangle_count(), 0u) << what;
  EXPECT_EQ(hash(found.mesh), hash(testing::extract_all_bricks(spheres, options).mesh)) << what;
}

// And those without any shortcut.
void expect_plain(const SphereSet& spheres, const ExtractOptions& options,
                  const std::string& what) {
  const ExtractResult found = make_cpu_extractor()->extract(spheres, options);
  EXPECT_GT(found.mesh.triangle_count(), 0u) << what;
  const ExtractResult plain = testing::extract_plainly(spheres, options);
  EXPECT_EQ(hash(found.mesh), hash(plain.mesh)) << what;
  EXPECT_EQ(found.stats.clamped_vertices, plain.stats.clamped_vertices) << what;
  EXPECT_EQ(found.stats.grid_clipped, plain.stats.grid_clipped) << what;
}

// Few balls in a wide box: blocks of 64 and more nodes a side hold several of them far apart.
SphereSet gas(Dice& dice) {
  std::vector<Sphere> spheres(static_cast<std::size_t>(dice.whole(2, 60)));
  const double half = dice.real(5, 16);
  for (Sphere& s : spheres) {
    for (int axis = 0; axis < 3; ++axis) s.center[axis] = dice.real(-half, half);
    s.radius = dice.real(0.3, 3);
  }
  return SphereSet(std::move(spheres));
}

TEST(BrickSearch, LosesNoBrickOfASparseGas) {
  Dice dice(1);
  for (int set = 0; set < testing::sets(120, 20); ++set) {
    const SphereSet spheres = gas(dice);
    expect_none_lost(spheres, at_spacing(kFields[set % 4], dice.real(0.25, 0.4)),
                     "set " + std::to_string(set));
  }
}

// Heaps of balls along a line, 150 and 1,100 spacings apart.
TEST(BrickSearch, LosesNoBrickOfLongGrids) {
  Dice dice(2);
  for (const double apart : {150.0, 1100.0, 5000.0}) {
    for (const FieldKind kind : kFields) {
      const double h = 0.3;
      std::vector<Sphere> spheres;
      for (int heap = 0; heap < 3; ++heap) {
        for (int i = 0; i < 3; ++i) {
          Vec3d c{dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)};
          c[static_cast<int>(kind) % 3] += heap * apart * h;
          spheres.push_back({c, dice.real(0.4, 1.5)});
        }
      }
      expect_none_lost(SphereSet(spheres), at_spacing(kind, h), std::to_string(apart));
    }
  }
}

// The value of a node is 0 but for rounding where an atom's window ends; isovalues that small see
// it. Bounds in double say that nothing is there.
TEST(BrickSearch, LosesNoBrickAtTheSmallestIsovalues) {
  Dice dice(3);
  for (int set = 0; set < testing::sets(60, 12); ++set) {
    const SphereSet spheres = gas(dice);
    ExtractOptions options = at_spacing(kFields[1 + set % 3], 0.5);
    options.field.isovalue = std::pow(10.0, -dice.real(3, 27));
    expect_none_lost(spheres, options, "isovalue " + std::to_string(*options.field.isovalue));
  }
}

// Exponents of -100 and more are 0 in float32 at a node and large at a vertex beside it.
TEST(Shortcuts, ChangeNothingForSteepFields) {
  Dice dice(4);
  for (const double blobbiness : {0.3, 7.0, 20.0, 50.0}) {
    for (const double h : {0.4, 1.1, 2.0}) {
      std::vector<Sphere> spheres;
      for (int i = 0; i < 25; ++i) {
        spheres.push_back(
            {{dice.real(-4, 4), dice.real(-4, 4), dice.real(-4, 4)}, dice.real(0.2, 3)});
      }
      ExtractOptions options = at_spacing(FieldKind::blinn, h);
      options.field.blobbiness = blobbiness;
      expect_plain(SphereSet(spheres), options, std::to_string(blobbiness));
    }
  }
}

// Balls as far from the origin as they may be, and the largest among small ones.
TEST(Shortcuts, ChangeNothingFarAwayOrAmongGiants) {
  Dice dice(5);
  for (const FieldKind kind : kFields) {
    for (const double far : {0.0, 99999.9, -999990.0}) {
      std::vector<Sphere> spheres;
      for (int i = 0; i < 20; ++i) {
        spheres.push_back({{far + dice.real(-3, 3), dice.real(-3, 3), -far + dice.real(-3, 3)},
                           i == 0 ? 6.0 : dice.real(0.05, 1)});
      }
      expect_plain(SphereSet(spheres), at_spacing(kind, 0.7), std::to_string(far));
    }
  }
  // A giant's surface cut out by a grid about the centres of the others.
  ExtractOptions options = at_spacing(FieldKind::vdw, 1000);
  expect_plain(SphereSet({{{0, 0, 0}, 4000}, {{4000, 0, 0}, 900}, {{0, 4400, 0}, 3}}), options,
               "giant");
}

// Nodes that a sphere passes at the distance of its own rounding, in double or in float32, at the
// corners of bricks and anywhere: single precision and the search must leave them to the predicate.
TEST(Shortcuts, LeaveNodesNearASphereToThePredicate) {
  const double h = 0.37;
  const GridSpec grid{{-0.123, 0.456, -7.89}, h, {37, 37, 37}};
  const FieldModel model = make_field_model({}, grid);
  Dice dice(6);
  int wrong = 0;
  for (int trial = 0; trial < 6000; ++trial) {
    const BrickIndex brick{dice.whole(1, 3), dice.whole(1, 3), dice.whole(1, 3)};
    const BrickGeometry g = brick_geometry(grid, brick);
    const bool corner = dice.one_in(2);
    const auto local = [&] { return corner ? kBrickSide * dice.whole(0, 1) : dice.whole(0, 8); };
    const int x = local(), y = local(), z = local();
    const Vec3d node = g.node(x, y, z);
    Sphere ball{node, dice.real(0.2, 6)};
    Vec3d away{dice.real(-1, 1), dice.real(-1, 1), dice.real(-1, 1)};
    ball.center = node + (ball.radius / std::max(norm(away), 0.1)) * away;
    const double shake = dice.one_in(2) ? 0 : dice.real(-2e-7, 2e-7);
    ball.radius = std::sqrt(squared_distance(node, ball.center)) * (1 + shake);
    const CellList list = make_ball_list(SphereSet({ball}));
    UnionBrick surface(list.view(), model);
    BrickSigns signs{};
    surface.visit(brick);
    surface.signs(signs);
    for (int k = 0; k < kBrickReach; ++k) {
      for (int j = 0; j < kBrickReach; ++j) {
        for (int i = 0; i < kBrickReach; ++i)
          wrong += (signs.row[k][j] >> i & 1) != (inside_ball(g.node(i, j, k), ball) ? 1 : 0);
      }
    }
  }
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace vdwmesh
