// What a ball covers of its neighbour's sphere, down to caps of which the cosine knows nothing; and
// what a boundary says of its points and pieces.
#include "creases/arcs/patch_boundary.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "complex/dual_complex.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "creases/arcs/point_circles.hpp"
#include "creases/patch/patch_quality.hpp"
#include "measures/exposed_boundary.hpp"
#include "spheres/directions.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

// Of the ball that stands at the origin.
PatchBoundary boundary_at_origin(const SphereSet& spheres) {
  const PowerTriangulation triangulation = triangulate(spheres);
  const ExposedBoundary exposed = exposed_boundary(triangulation, dual_complex(triangulation));
  const BoundaryArcs arcs = boundary_arcs(triangulation, exposed);
  const ArcSampling sampling(arcs, std::vector<double>(triangulation.balls.size(), 1));
  const PatchIndex index(triangulation, exposed, arcs);
  std::uint32_t ball = 0;
  while (norm(triangulation.balls[ball].center) > 0) ++ball;
  PatchBoundary boundary;
  gather_boundary(triangulation, arcs, sampling, index, ball, boundary);
  return boundary;
}

// A hair on either side of the rim, whose points come from the arcs.
void expect_rim(const CoveredCap& cap, std::span<const Vec3d> rim) {
  const Vec3d middle = cap.cosine >= 0 ? cap.axis : -1.0 * cap.axis;
  for (const Vec3d& p : rim) {
    const Vec3d inwards = unit(p + 0.001 * (middle - p)), outwards = unit(p - 0.001 * (middle - p));
    EXPECT_EQ(cap.covers(inwards), cap.cosine >= 0);
    EXPECT_EQ(cap.covers(outwards), cap.cosine < 0);
  }
}

TEST(PatchBoundary, ACapCoversWhatLiesWithinItsRim) {
  for (const double overlap : {1e-15, 1e-12, 1e-8, 1e-4, 0.1}) {
    for (const double radius : {0.0001220703125, 0.5, 2.5, 4.0}) {
      SCOPED_TRACE(::testing::Message() << overlap << " of " << radius);
      if (overlap >= radius) continue;
      const PatchBoundary boundary = boundary_at_origin(
          SphereSet({{{0, 0, 0}, 2.5}, {{2.5 + radius - overlap, 0, 0}, radius}}));
      ASSERT_EQ(boundary.caps.size(), 1u);
      const CoveredCap& cap = boundary.caps[0];
      const bool has_no_arc = boundary.pieces.empty();
      const double squared_circle_radius = 2 * overlap * radius * 2.5 / (2.5 + radius);
      constexpr double kContact = 1e-6;  // of the smaller radius: what the header promises
      EXPECT_EQ(has_no_arc, std::sqrt(squared_circle_radius) <= kContact * std::min(radius, 2.5));
      EXPECT_EQ(cap.covers(cap.axis), !has_no_arc);
      EXPECT_FALSE(cap.covers(-1.0 * cap.axis));
      expect_rim(cap, boundary.points);
    }
  }
}

TEST(PatchBoundary, ACapMayLeaveNextToNothing) {
  for (const double left : {1e-11, 1e-9, 1e-6, 1e-3, 0.1}) {
    SCOPED_TRACE(left);
    const PatchBoundary boundary =
        boundary_at_origin(SphereSet({{{0, 0, 0}, 0.5}, {{0, 2 + left, 0}, 2.5}}));
    ASSERT_EQ(boundary.caps.size(), 1u);
    const CoveredCap& cap = boundary.caps[0];
    EXPECT_TRUE(cap.covers(cap.axis));
    EXPECT_FALSE(cap.covers(-1.0 * cap.axis));
    ASSERT_GE(boundary.points.size(), 8u);
    expect_rim(cap, boundary.points);
  }
}

// Of what all but touches no arc is left, so it covers nothing, however much wider than the cap of
// the small ball it would be. Of both the cosine is 1.
TEST(PatchBoundary, ThePoleIsNoContact) {
  const double radius = std::ldexp(1.0, -13);
  const Sphere large{{0, 0, 0}, 1.5}, small{{0, std::nextafter(1.5 + radius, 0), 0}, radius};
  for (const double touching_radius : {radius, 0.5, 2.0}) {
    for (const int steps : {0, 1, 4}) {
      SCOPED_TRACE(::testing::Message() << steps << " steps, radius " << touching_radius);
      if (touching_radius == radius && steps > 0) continue;  // a cap like the other
      double x = 1.5 + touching_radius;
      for (int i = 0; i < steps; ++i) x = std::nextafter(x, 0);
      const Sphere touching{{x, 0, 0}, touching_radius};
      for (const auto& spheres :
           {SphereSet({large, touching, small}), SphereSet({small, touching, large})}) {
        const Vec3d pole = buried_pole(boundary_at_origin(spheres));
        EXPECT_EQ(norm(pole - Vec3d{0, 1, 0}), 0) << pole.x << ' ' << pole.y << ' ' << pole.z;
      }
    }
  }
}

// A boundary that was split is the one that is gathered after the split, but for the order, and the
// sources of its points lead to the same vertices.
void expect_same(const PatchBoundary& split, const std::vector<std::uint32_t>& vertices,
                 const PatchBoundary& gathered,
                 const std::vector<std::uint32_t>& gathered_vertices) {
  ASSERT_EQ(split.points.size(), gathered.points.size());
  ASSERT_EQ(split.pieces.size(), gathered.pieces.size());
  for (const BoundaryPiece& p : split.pieces) {
    const auto same = std::find_if(gathered.pieces.begin(), gathered.pieces.end(),
                                   [&](const BoundaryPiece& q) { return p.source == q.source; });
    ASSERT_NE(same, gathered.pieces.end());
    EXPECT_EQ(split.points[p.from], gathered.points[same->from]);
    EXPECT_EQ(split.points[p.to], gathered.points[same->to]);
    EXPECT_EQ(vertices[p.from], gathered_vertices[same->from]);
    EXPECT_EQ(vertices[p.to], gathered_vertices[same->to]);
    EXPECT_EQ(p.neighbor, same->neighbor);
    // Angles between sample points of up to 2 pi, rounded a few times.
    constexpr double kRounding = 1e-14;
    EXPECT_NEAR(p.bulge, same->bulge, kRounding);
  }
}

std::vector<std::uint32_t> vertices_by_sources(const BoundaryArcs& arcs,
                                               const ArcSampling& sampling, std::uint32_t ball,
                                               const PatchBoundary& points) {
  std::vector<PointSource> sources(points.points.size());
  point_sources(arcs, sampling, ball, points, sources);
  std::vector<std::uint32_t> vertices;
  for (const PointSource& source : sources) {
    vertices.push_back(source.vertex(sampling.first_vertices().data()));
  }
  return vertices;
}

TEST(PatchBoundary, SplitPiecesAreThoseGatheredAfterwards) {
  testing::Dice dice(3);
  std::vector<Sphere> spheres;
  for (int i = 0; i < 40; ++i) {
    spheres.push_back({{dice.real(0, 6), dice.real(0, 6), dice.real(0, 6)}, dice.real(1, 2)});
  }
  // Two that meet in a whole circle.
  spheres.push_back({{20, 0, 0}, 1.5});
  spheres.push_back({{22, 0, 0}, 1});
  const PowerTriangulation triangulation = triangulate(SphereSet(std::move(spheres)));
  const ExposedBoundary exposed = exposed_boundary(triangulation, dual_complex(triangulation));
  const BoundaryArcs arcs = boundary_arcs(triangulation, exposed);
  ArcSampling sampling(arcs, std::vector<double>(triangulation.balls.size(), 0.1));
  const PatchIndex index(triangulation, exposed, arcs);
  const auto balls = static_cast<std::uint32_t>(triangulation.balls.size());
  std::vector<PatchBoundary> boundaries(balls);
  for (std::uint32_t b = 0; b < balls; ++b) {
    gather_boundary(triangulation, arcs, sampling, index, b, boundaries[b]);
  }
  for (int round = 0; round < 3; ++round) {
    std::vector<PieceSplit> splits;
    for (std::uint32_t a = 0; a < arcs.arcs.size(); ++a) {
      for (std::uint32_t k = 0; k < sampling.pieces(a); ++k) {
        if (dice.one_in(3)) splits.push_back({{a, k}, dice.one_in(2) ? 1u : 2u});
      }
    }
    sampling.split(splits);
    sampling.number_vertices();
    for (std::uint32_t b = 0; b < balls; ++b) {
      PatchVector<SplitChain> chains;
      split_pieces(arcs, sampling, triangulation.balls[b], b, splits, boundaries[b], chains);
      PatchBoundary gathered;
      gather_boundary(triangulation, arcs, sampling, index, b, gathered);
      std::vector<std::uint32_t> gathered_vertices;
      boundary_vertices(arcs, sampling, index, b, gathered_vertices);
      expect_same(boundaries[b], vertices_by_sources(arcs, sampling, b, boundaries[b]), gathered,
                  gathered_vertices);
    }
  }
}

// A boundary by its pieces alone, as (from, to, neighbor).
PatchBoundary boundary_of(std::uint32_t points,
                          const std::vector<std::array<std::uint32_t, 3>>& pieces) {
  PatchBoundary boundary;
  boundary.points.resize(points);
  for (const auto& [from, to, neighbor] : pieces) {
    boundary.pieces.push_back({from, to, neighbor, {}, 0});
  }
  return boundary;
}

// Closed curves, points where two of them meet, as many points as pieces but one point without any,
// and other spheres through a point.
TEST(PointCircles, AreThoseOfThePiecesThatEndThere) {
  PatchBoundary joined = boundary_of(3, {{0, 1, 7}, {1, 2, 8}, {2, 0, 9}});
  joined.through.push_back({1, 5});
  const std::vector<PatchBoundary> boundaries{
      boundary_of(0, {}), boundary_of(5, {{0, 1, 7}, {1, 2, 7}, {2, 0, 8}, {4, 3, 9}, {3, 4, 9}}),
      boundary_of(5, {{0, 1, 4}, {1, 2, 5}, {2, 0, 6}, {0, 3, 7}, {3, 4, 8}, {4, 0, 9}}),
      boundary_of(4, {{0, 1, 7}, {1, 0, 8}, {0, 2, 7}, {2, 0, 8}}), joined};
  PointCircles circles;
  for (const PatchBoundary& boundary : boundaries) {
    circles.assign(boundary);
    const auto passes = [&](std::uint32_t point, std::uint32_t neighbor) {
      return std::ranges::any_of(boundary.pieces,
                                 [&](const BoundaryPiece& p) {
                                   return p.neighbor == neighbor &&
                                          (p.from == point || p.to == point);
                                 }) ||
             std::ranges::any_of(boundary.through, [&](const SphereThrough& s) {
               return s.point == point && s.ball == neighbor;
             });
    };
    // Points beyond the boundary are interior points.
    for (std::uint32_t point = 0; point < 8; ++point) {
      for (std::uint32_t neighbor = 0; neighbor < 12; ++neighbor) {
        EXPECT_EQ(circles.on(point, neighbor), passes(point, neighbor)) << point << " " << neighbor;
      }
      for (std::uint32_t other = 0; other < 8; ++other) {
        bool shares = false;
        for (std::uint32_t n = 0; n < 12; ++n) shares |= passes(point, n) && passes(other, n);
        EXPECT_EQ(circles.share(point, other), shares) << point << " " << other;
      }
    }
  }
}

// With the roots and quotients that most pieces do without, in all sizes and around the thresholds.
TEST(PatchQuality, PiecesAreLongByTheDefinition) {
  testing::Dice dice(7);
  std::size_t long_at_corner = 0, narrow = 0;
  constexpr int kTries = 200'000;
  for (int i = 0; i < kTries; ++i) {
    const double size = std::pow(10.0, dice.real(-9, 0)), width = size * dice.real(0.25, 0.35);
    const Vec3d a{0.6, 0, 0.8}, along = unit(Vec3d{dice.real(-1, 1), dice.real(-1, 1), 1});
    const Vec3d across = any_orthogonal(along), b = a + size * along;
    const bool on_threshold = dice.one_in(4);
    const Vec3d p = a + size * dice.real(-0.4, 1.4) * along +
                    (on_threshold ? kLocalWidth * size : width) * across;
    const Vec3d q = b + size * (on_threshold ? 1 / kCornerRatio : dice.real(0.3, 0.7)) * across;
    const double length = norm(b - a);
    EXPECT_EQ(is_long_at_corner(a, b, b, q), length > kCornerRatio * norm(q - b));
    const double foot = dot(p - a, b - a) / squared_norm(b - a);
    const double height = norm(cross(b - a, p - a)) / length;
    const bool is_narrow = foot > -0.2 && foot < 1.2 && height < kLocalWidth * length;
    EXPECT_EQ(halvings_for_width(a, b, p),
              is_narrow ? (height * 2 < kLocalWidth * length ? 2u : 1u) : 0u);
    long_at_corner += is_long_at_corner(a, b, b, q);
    narrow += is_narrow;
  }
  for (const std::size_t count : {long_at_corner, narrow}) {
    EXPECT_GT(count, kTries / 10u);
    EXPECT_LT(count, kTries * 9u / 10);
  }
}

}  // namespace
}  // namespace vdwmesh
