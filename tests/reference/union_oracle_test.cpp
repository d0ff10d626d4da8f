// The oracle with 60 digits against closed forms: in double, and of lattices with more digits.
#include "reference/union_oracle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/closed_forms.hpp"

namespace vdwmesh::reference {
namespace {

constexpr double kDouble = 1e-14;  // relative, of closed forms evaluated in double

void expect_equal(const WideMeasures& found, const Measures& expected) {
  EXPECT_LE(abs(found.area / expected.area - 1), kDouble);
  EXPECT_LE(abs(found.volume / expected.volume - 1), kDouble);
}

TEST(UnionOracle, ClosedForms) {
  expect_equal(union_oracle({{{{1, 2, 3}}, 1.5}}), ball(1.5));
  expect_equal(union_oracle({{{{1, 2, 3}}, 1.5}, {{{2, 3, 3.5}}, 1.2}}), two_balls(1.5, 1.2, 1.5));
  const std::array<Ball, 3> three{
      {{{{0, 0, 0}}, 1}, {{{1, 0.2, 0}}, 1.1}, {{{0.4, 0.9, 0.1}}, 0.9}}};
  expect_equal(union_oracle({three.begin(), three.end()}), three_balls(three));
}

// Balls with radius 1/2 on integers touch without overlap; a ball that is given twice, one inside
// and one that touches from inside add nothing.
TEST(UnionOracle, DegenerateSets) {
  std::vector<Ball> balls;
  for (int i = 0; i < 8; ++i) {
    balls.push_back({{{double(i % 2), double(i / 2 % 2), double(i / 4)}}, 0.5});
  }
  balls.push_back(balls.front());
  balls.push_back({{{0, 0, 0.1}}, 0.3});
  balls.push_back({{{0, 0.25, 0}}, 0.25});
  const WideMeasures found = union_oracle(balls);
  const Digits pi = acos(Digits(-1)), tiny("1e-60");
  EXPECT_LE(abs(found.area - 8 * pi), tiny);
  EXPECT_LE(abs(found.volume - 8 * pi / 6), tiny);
}

// Two equal caps and two complementary ones: three balls in a row, the outer ones larger, whose
// circles on the middle ball coincide, so that the middle one has no area.
TEST(UnionOracle, CirclesThatCoincide) {
  const std::vector<Ball> outer{{{{-1, 0, 0}}, 1.25}, {{{1, 0, 0}}, 1.25}};
  std::vector<Ball> with_middle = outer;
  with_middle.push_back({{{0, 0, 0}}, 0.75});  // 0.75² + 1² = 1.25²
  const WideMeasures expected = union_oracle(outer), found = union_oracle(with_middle);
  const Digits tiny("1e-60");
  EXPECT_LE(abs(found.area - expected.area), tiny);
  EXPECT_LE(abs(found.volume - expected.volume), tiny);
}

}  // namespace
}  // namespace vdwmesh::reference
