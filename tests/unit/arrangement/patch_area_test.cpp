// What chords and flat triangles take from the area of a patch, held against spherical
// trigonometry, and which pieces are split for it.
#include "creases/patch/patch_area.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace vdwmesh {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

// A circle of angular radius `angle` around `axis`, 0: +z, 1: -z, of `count` pieces, with the patch
// outside of it. Pieces of arc `axis` are numbered along it.
void add_circle(std::uint32_t axis, double angle, std::uint32_t count, PatchBoundary& out) {
  const auto first = static_cast<std::uint32_t>(out.points.size());
  const double z = axis == 0 ? 1 : -1, step = 2 * kHalfTurn / count;
  for (std::uint32_t k = 0; k < count; ++k) {
    out.points.push_back({std::sin(angle) * std::cos(k * step),
                          std::sin(angle) * std::sin(k * step), z * std::cos(angle)});
    out.pieces.push_back(
        {first + k, first + (k + 1) % count, axis, {axis, k}, step * std::cos(angle) / 2});
  }
}

PatchBoundary one_circle(double angle, std::uint32_t count) {
  PatchBoundary boundary;
  add_circle(0, angle, count, boundary);
  return boundary;
}

// Of a piece of angle x on a circle of angular radius a: the sector of the cap, x (1 - cos a), less
// the triangle of its ends and the cap's centre. Two sides a and the angle x between them give its
// excess, tan(E/2) = tan²(a/2) sin x / (1 + tan²(a/2) cos x). The formula leaves out terms of the
// fourth order; they are under a fifth of x² for every circle.
TEST(PatchArea, LensIsTheSectorLessTheTriangle) {
  for (const double a : {0.1, 0.5, 1.0, 1.4, 1.7, 2.5, 3.0}) {
    for (const std::uint32_t count : {8u, 16u, 32u, 256u}) {
      SCOPED_TRACE(::testing::Message() << a << ", " << count << " pieces");
      const double x = 2 * kHalfTurn / count, t = std::pow(std::tan(a / 2), 2);
      const double excess = 2 * std::atan2(t * std::sin(x), 1 + t * std::cos(x));
      const double lens = x * (1 - std::cos(a)) - excess;
      const PatchBoundary boundary = one_circle(a, count);
      for (const BoundaryPiece& piece : boundary.pieces) {
        EXPECT_NEAR(lens_area(boundary, piece) / lens, 1, x * x / 5 + 1e-9);
      }
    }
  }
}

// The spherical triangle with three equal chords h has the sides s = 2 asin(h/2) and angles with
// the cosine cos s / (1 + cos s); its area is their sum less π.
TEST(PatchArea, FlatTriangleErrorIsThatOfEquilateralTriangles) {
  for (const double h : {0.4, 0.2, 0.1}) {
    const double side = 2 * std::asin(h / 2);
    const double area = 3 * std::acos(std::cos(side) / (1 + std::cos(side))) - kHalfTurn;
    const double flat = std::sqrt(3.0) / 4 * h * h;
    EXPECT_NEAR(flat_triangle_error(area, h) / (area - flat), 1, h * h / 20);
  }
}

// The error of the mesh of a patch between great circles and the given pieces, by the exact lens.
double error_of(const PatchBoundary& boundary, double area, double h) {
  double error = -flat_triangle_error(area, h);
  for (const BoundaryPiece& piece : boundary.pieces) error += lens_area(boundary, piece);
  return error;
}
double most_error(double area, double h) {
  return std::max(kLargestAreaError * std::max(area, kCountedArea * h * h),
                  kFlatTriangleErrors * flat_triangle_error(area, h));
}

TEST(PatchArea, PiecesAreSplitWhereTheErrorIsTooLarge) {
  for (const double angle : {0.3, 0.8, 1.3, 1.9, 2.6}) {
    for (const std::uint32_t count : {8u, 12u, 40u}) {
      for (const double area : {0.001, 0.05, 1.0}) {
        for (const double h : {0.02, 0.1, 0.3}) {
          PatchVector<PieceSplit> splits;
          const PatchBoundary boundary = one_circle(angle, count);
          split_for_area(boundary, area, h, splits);
          const bool is_large = std::abs(error_of(boundary, area, h)) > most_error(area, h);
          // All pieces are equal, so all of them are split.
          EXPECT_EQ(splits.size(), is_large ? count : 0);
        }
      }
    }
  }
}

// Two circles: on one side chords add area, on the other they take some. Only the side that makes
// the error is split, and of several arcs the coarse one first.
TEST(PatchArea, TheLargestLensesToBlameAreSplit) {
  PatchBoundary boundary;
  add_circle(0, 0.8, 8, boundary);    // adds
  add_circle(1, 1.9, 64, boundary);   // takes away
  add_circle(1, 0.75, 32, boundary);  // adds, but less than an eighth of the first one's
  PatchVector<PieceSplit> splits;
  split_for_area(boundary, 0.1, 0.02, splits);
  ASSERT_EQ(splits.size(), 8u);
  std::set<ArcPiece> pieces;
  for (const PieceSplit& s : splits) {
    EXPECT_EQ(s.piece.arc, 0u);
    EXPECT_EQ(s.halvings, 1u);
    pieces.insert(s.piece);
  }
  EXPECT_EQ(pieces.size(), 8u);
}

// Rounds of splits end, and with an error that is small enough; never with a piece split more often
// than its lens asks for.
TEST(PatchArea, RoundsOfSplitsReachTheBound) {
  for (const double angle : {0.3, 0.8, 1.3, 1.9, 2.6}) {
    constexpr double kArea = 0.01, kLength = 0.01;
    std::uint32_t count = 8;
    int rounds = 0;
    for (;; count *= 2, ++rounds) {
      PatchVector<PieceSplit> splits;
      split_for_area(one_circle(angle, count), kArea, kLength, splits);
      if (splits.empty()) break;
      ASSERT_EQ(splits.size(), count);
      ASSERT_LT(rounds, 12);
    }
    EXPECT_GT(rounds, 0);
    EXPECT_LE(std::abs(error_of(one_circle(angle, count), kArea, kLength)),
              most_error(kArea, kLength));
    EXPECT_GT(std::abs(error_of(one_circle(angle, count / 2), kArea, kLength)),
              most_error(kArea, kLength));
  }
}

}  // namespace
}  // namespace vdwmesh
