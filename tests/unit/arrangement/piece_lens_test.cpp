// Which points of the plane lie between a piece and its arc, by points that are placed there.
#include "creases/plane/piece_lens.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/ball_families.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;
using testing::random_direction;

constexpr double kPi = std::numbers::pi;

// A point of the plane at a share of the way from a to b.
PlanePoint between(const PlanePoint& a, const PlanePoint& b, double share) {
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)};
}

// Pieces of random circles of the sphere in random projections. A lens is convex, so every point
// between one on the piece and one on the arc is in it. A point beyond the arc is not, nor is one
// on the other side of the piece.
TEST(PieceLens, HoldsWhatIsBetweenChordAndArc) {
  Dice dice(2511);
  int tried = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d axis = random_direction(dice), first = any_orthogonal(axis),
                second = cross(axis, first), pole = random_direction(dice);
    const double radius = dice.real(0.02, kPi - 0.02), from = dice.real(0, 2 * kPi);
    const double sweep = std::pow(10, dice.real(-4, 0)) * kPi / 4;
    const auto at = [&](double share) {
      const double x = from + share * sweep;
      return std::cos(radius) * axis +
             std::sin(radius) * (std::cos(x) * first + std::sin(x) * second);
    };
    if (dot(pole, at(0.5)) > 0) continue;
    // Counter-clockwise about the axis a great circle turns left of an arc that is nearer to it.
    const double bulge = -sweep / 2 * std::cos(radius);
    const Stereographic projection(pole);
    const PieceLens lens(at(0), at(1), bulge, projection);
    const PlanePoint a = projection.project(at(0)), b = projection.project(at(1));
    const double share = dice.real(0.1, 0.9);
    const PlanePoint on_piece = between(a, b, share), on_arc = projection.project(at(share));
    // Where arc and piece are the same but for rounding, there is nothing in between.
    const double height = std::hypot(on_arc.x - on_piece.x, on_arc.y - on_piece.y);
    if (height < 1e-3 * sweep * std::hypot(b.x - a.x, b.y - a.y)) continue;
    ++tried;
    EXPECT_FALSE(lens.contains(between(on_piece, on_arc, -0.1))) << i;
    EXPECT_TRUE(lens.contains(between(on_piece, on_arc, dice.real(0.01, 0.99)))) << i;
    EXPECT_FALSE(lens.contains(between(on_piece, on_arc, 1.01))) << i;
    const PlanePoint center = lens.center();
    EXPECT_LE(std::hypot(on_arc.x - center.x, on_arc.y - center.y), (1 + 1e-9) * lens.radius())
        << i;
  }
  EXPECT_GT(tried, 1000);
}

}  // namespace
}  // namespace vdwmesh
