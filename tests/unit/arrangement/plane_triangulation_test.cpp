// The constrained Delaunay triangulation of patches against its definition and against CGAL's: on
// random, co-circular, collinear and nearly degenerate points, and on the boundaries of patches.
#include "creases/plane/plane_triangulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "complex/dual_complex.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/plane/stereographic.hpp"
#include "measures/exposed_boundary.hpp"
#include "reference/planar_delaunay.hpp"
#include "structure/reader.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using reference::FlatPoint;
using reference::FlatSegment;
using reference::FlatTriangle;
using testing::Dice;
using Outcome = PlaneTriangulation::Outcome;
using Place = PlaneTriangulation::Place;

// Points and segments in a square. The square's corners are the last four points, and its sides the
// last four segments, so that the triangles in the hull are those without corner of the frame.
struct Figure {
  std::vector<FlatPoint> points;
  std::vector<FlatSegment> segments;

  void enclose() {
    double e = 0;
    for (const FlatPoint& p : points) e = std::max({e, std::abs(p[0]), std::abs(p[1])});
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const FlatPoint& p :
         {FlatPoint{-2 * e, -2 * e}, {2 * e, -2 * e}, {2 * e, 2 * e}, {-2 * e, 2 * e}}) {
      points.push_back(p);
    }
    for (std::uint32_t i = 0; i < 4; ++i) segments.push_back({first + i, first + (i + 1) % 4});
  }
};

std::vector<PlanePoint> plane_points(const Figure& figure) {
  std::vector<PlanePoint> points;
  for (const FlatPoint& p : figure.points) points.push_back({p[0], p[1]});
  return points;
}

void insert_points(PlaneTriangulation& plane, std::size_t count) {
  std::uint32_t near = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto at = plane.locate(plane.point(i), near);
    ASSERT_TRUE(at.place == Place::inside || at.place == Place::on_edge) << i;
    plane.insert(i, at);
    near = plane.triangle_at(i);
  }
}

std::vector<FlatTriangle> triangles_in_hull(const PlaneTriangulation& plane) {
  std::vector<FlatTriangle> triangles;
  for (std::uint32_t t = 0; t < plane.triangles().size(); ++t) {
    if (!plane.touches_frame(t)) triangles.push_back(plane.triangle(t).vertices);
  }
  return reference::sorted(std::move(triangles));
}

std::vector<FlatTriangle> triangulated(const Figure& figure, PlaneTriangulation& plane,
                                       const PointCircles* circles = nullptr) {
  plane.start(plane_points(figure), circles);
  insert_points(plane, figure.points.size());
  for (std::uint32_t s = 0; s < figure.segments.size(); ++s) {
    const auto [a, b] = figure.segments[s];
    EXPECT_EQ(plane.insert_piece(a, b, s), Outcome::inserted) << s;
  }
  return triangles_in_hull(plane);
}

void expect_delaunay(Figure figure) {
  figure.enclose();
  PlaneTriangulation plane;
  EXPECT_EQ(reference::fault(figure.points, figure.segments, triangulated(figure, plane)), "");
}

void expect_as_cgal(Figure figure) {
  figure.enclose();
  PlaneTriangulation plane;
  const auto triangles = triangulated(figure, plane);
  EXPECT_EQ(triangles, reference::constrained_delaunay(figure.points, figure.segments));
  EXPECT_EQ(reference::fault(figure.points, figure.segments, triangles), "");
}

Figure random_points(Dice& dice, int count) {
  Figure figure;
  for (int i = 0; i < count; ++i) figure.points.push_back({dice.real(-1, 1), dice.real(-1, 1)});
  return figure;
}

// Tries `count` random segments and keeps those that meet the others, and points, in their ends
// only.
void add_segments(Dice& dice, int count, Figure& figure) {
  const auto& points = figure.points;
  const int last = static_cast<int>(points.size()) - 1;
  for (int i = 0; i < count; ++i) {
    const auto a = static_cast<std::uint32_t>(dice.whole(0, last)),
               b = static_cast<std::uint32_t>(dice.whole(0, last));
    if (a == b) continue;
    const auto is_crossed = [&](const FlatSegment& s) {
      const auto& [c, d] = s;
      const bool same = (a == c && b == d) || (a == d && b == c);
      const bool joined = a == c || a == d || b == c || b == d;
      return same || (!joined && reference::meet(points[a], points[b], points[c], points[d]));
    };
    bool free = std::none_of(figure.segments.begin(), figure.segments.end(), is_crossed);
    for (std::uint32_t p = 0; p < points.size() && free; ++p) {
      free = p == a || p == b || !reference::meet(points[a], points[b], points[p], points[p]);
    }
    if (free) figure.segments.push_back({a, b});
  }
}

TEST(PlaneTriangulation, RandomPointsAndSegmentsAsCgal) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure = random_points(dice, dice.whole(1, 150));
    add_segments(dice, dice.whole(0, 80), figure);
    expect_as_cgal(std::move(figure));
  }
}

TEST(PlaneTriangulation, PointsOfAGridAreDelaunay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure;
    for (int x = -4; x <= 4; ++x) {
      for (int y = -4; y <= 4; ++y) {
        if (!dice.one_in(5)) figure.points.push_back({0.25 * x, 0.25 * y});
      }
    }
    for (std::size_t i = figure.points.size(); i > 1; --i) {
      std::swap(figure.points[i - 1],
                figure.points[static_cast<std::size_t>(dice.whole(0, static_cast<int>(i) - 1))]);
    }
    add_segments(dice, 30, figure);
    expect_delaunay(std::move(figure));
  }
}

// The points of circles, rounded, in order and in disorder: every test of four of them is noise.
TEST(PlaneTriangulation, PointsOfCirclesAreDelaunay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure;
    for (int c = dice.whole(1, 3); c > 0; --c) {
      const double x = dice.real(-1, 1), y = dice.real(-1, 1), r = dice.real(0.1, 1);
      const int count = dice.whole(3, 60);
      for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * (dice.one_in(2) ? i : i + 0.25) / count;
        figure.points.push_back({x + r * std::cos(angle), y + r * std::sin(angle)});
      }
    }
    expect_delaunay(std::move(figure));
  }
}

TEST(PlaneTriangulation, NearlyCollinearPointsAreDelaunay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure;
    const double slope = dice.real(-2, 2), noise = std::pow(10.0, dice.whole(-18, -3));
    for (int i = 0; i < 60; ++i) {
      const double x = dice.real(-1, 1);
      figure.points.push_back({x, slope * x + noise * dice.real(-1, 1)});
    }
    add_segments(dice, 20, figure);
    expect_delaunay(std::move(figure));
  }
}

// Clusters of 1e-12 beside points at 1, and neighbouring doubles.
TEST(PlaneTriangulation, ClustersOfPointsAreDelaunay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure = random_points(dice, 10);
    const FlatPoint middle = figure.points[0];
    for (int i = 0; i < 30; ++i) {
      figure.points.push_back(
          {middle[0] + 1e-12 * dice.real(-1, 1), middle[1] + 1e-12 * dice.real(-1, 1)});
    }
    for (int i = 1; i < 10; ++i) {
      const FlatPoint p = figure.points[static_cast<std::size_t>(i)];
      figure.points.push_back({std::nextafter(p[0], 2), p[1]});
      figure.points.push_back({p[0], std::nextafter(p[1], 2)});
    }
    std::sort(figure.points.begin(), figure.points.end());
    figure.points.erase(std::unique(figure.points.begin(), figure.points.end()),
                        figure.points.end());
    add_segments(dice, 20, figure);
    expect_delaunay(std::move(figure));
  }
}

// Long segments between two rows of points, each crossing many edges.
TEST(PlaneTriangulation, SegmentsAcrossManyEdgesAsCgal) {
  Dice dice(5);
  Figure figure;
  figure.points = {{-1, 0}, {1, 0.001}};
  for (int i = 0; i < 100; ++i) {
    figure.points.push_back({dice.real(-0.9, 0.9), dice.real(0.01, 0.3)});
    figure.points.push_back({dice.real(-0.9, 0.9), dice.real(-0.3, -0.01)});
  }
  figure.segments = {{0, 1}};
  expect_as_cgal(std::move(figure));
}

// A square from (-1, -1) to (1, 1), vertices 0 to 3, with vertex 4 in the middle.
void start_square(PlaneTriangulation& plane) {
  const std::vector<PlanePoint> points{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, 0}};
  plane.start(points, nullptr);
  insert_points(plane, points.size());
}

TEST(PlaneTriangulation, SaysWhatIsInTheWayOfAPiece) {
  PlaneTriangulation plane;
  start_square(plane);
  EXPECT_EQ(plane.insert_piece(0, 2, 0), Outcome::blocked) << "by vertex 4";
  EXPECT_EQ(plane.insert_piece(0, 1, 0), Outcome::inserted);
  EXPECT_EQ(plane.insert_piece(1, 0, 1), Outcome::doubled);
  EXPECT_EQ(plane.insert_piece(3, 4, 2), Outcome::inserted);
  EXPECT_EQ(plane.insert_piece(2, 2, 3), Outcome::blocked);
}

TEST(PlaneTriangulation, SaysThatPiecesCross) {
  const std::vector<PlanePoint> points{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  PlaneTriangulation plane;
  plane.start(points, nullptr);
  insert_points(plane, points.size());
  EXPECT_EQ(plane.insert_piece(0, 2, 0), Outcome::inserted);
  EXPECT_EQ(plane.insert_piece(1, 3, 1), Outcome::crossing);
}

TEST(PlaneTriangulation, SaysWhereAPointLies) {
  PlaneTriangulation plane;
  start_square(plane);
  EXPECT_EQ(plane.locate({0.25, -0.5}, 0).place, Place::inside);
  EXPECT_EQ(plane.locate({0.5, 0.5}, 0).place, Place::on_edge);
  EXPECT_EQ(plane.locate({1e300, 0}, 0).place, Place::outside);
  EXPECT_EQ(plane.locate({std::nan(""), 0}, 0).place, Place::outside);
  const auto vertex = plane.locate({1, -1}, 0);
  EXPECT_EQ(vertex.place, Place::on_vertex);
  EXPECT_EQ(plane.triangle(vertex.triangle).vertices[vertex.corner], 1u);
}

// The pieces are the sides of the square; from a point near one of them, all are in view, but only
// those that the circles of the triangles around the point reach are found.
TEST(PlaneTriangulation, FindsThePiecesAroundAPoint) {
  PlaneTriangulation plane;
  start_square(plane);
  for (std::uint32_t i = 0; i < 4; ++i) plane.insert_piece(i, (i + 1) % 4, i);
  const PlanePoint p{0, -0.9};
  const auto found = plane.pieces_around(p, plane.locate(p, 0).triangle);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(plane.triangle(found[0].triangle).pieces[found[0].corner], 0u);
}

// The boundaries of all patches of ubiquitin.
struct Patches {
  PowerTriangulation triangulation;
  ExposedBoundary exposed;
  BoundaryArcs arcs;
  ArcSampling sampling;
  PatchIndex index;

  explicit Patches(const SphereSet& spheres)
      : triangulation(triangulate(spheres)),
        exposed(exposed_boundary(triangulation, dual_complex(triangulation))),
        arcs(boundary_arcs(triangulation, exposed)),
        sampling(arcs, std::vector<double>(triangulation.balls.size(),
                                           std::ldexp(0.35, -triangulation.scale_exponent))),
        index(triangulation, exposed, arcs) {}

  void each(const std::function<void(const PatchBoundary&, const Figure&)>& visit) const {
    for (std::uint32_t b = 0; b < triangulation.balls.size(); ++b) {
      if (index.arcs(b).empty()) continue;
      PatchBoundary boundary;
      gather_boundary(triangulation, arcs, sampling, index, b, boundary);
      const Stereographic projection(buried_pole(boundary));
      Figure figure;
      for (const Vec3d& u : boundary.points) {
        const PlanePoint p = projection.project(u);
        figure.points.push_back({p.x, p.y});
      }
      for (const BoundaryPiece& p : boundary.pieces) figure.segments.push_back({p.from, p.to});
      figure.enclose();
      visit(boundary, figure);
    }
  }
};

Patches ubiquitin() {
  std::vector<Sphere> spheres;
  for (const Atom& atom : read_sample("ubiquitin").atoms)
    spheres.push_back({atom.position, atom.radius});
  return Patches(SphereSet(std::move(spheres)));
}

TEST(PlaneTriangulation, BoundariesOfPatchesAsCgal) {
  std::size_t patches = 0;
  PlaneTriangulation plane;
  ubiquitin().each([&](const PatchBoundary&, const Figure& figure) {
    SCOPED_TRACE(++patches);
    EXPECT_EQ(triangulated(figure, plane),
              reference::constrained_delaunay(figure.points, figure.segments));
  });
  EXPECT_GT(patches, 400u);
}

// How far d lies inside the circle through a, b and c, as a fraction of the circle's radius.
double depth_in_circle(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c,
                       const FlatPoint& d) {
  const double bx = b[0] - a[0], by = b[1] - a[1], cx = c[0] - a[0], cy = c[1] - a[1];
  const double bb = bx * bx + by * by, cc = cx * cx + cy * cy, twice = 2 * (bx * cy - by * cx);
  const double x = (cy * bb - by * cc) / twice, y = (bx * cc - cx * bb) / twice;
  return 1 - std::hypot(d[0] - a[0] - x, d[1] - a[1] - y) / std::hypot(x, y);
}

// With labels, triangles differ from CGAL's only where all their vertices and the vertices beyond
// their edges lie on one circle, by their labels or to within a tie. That takes nearly all exact
// tests away.
TEST(PlaneTriangulation, LabelsDecideOnlyTies) {
  PlaneTriangulation plane;
  std::uint64_t with = 0, without = 0, tied = 0;
  ubiquitin().each([&](const PatchBoundary& boundary, const Figure& figure) {
    triangulated(figure, plane);
    without += plane.exact_tests();
    const PointCircles circles(boundary);
    triangulated(figure, plane, &circles);
    with += plane.exact_tests();
    const auto triangles = plane.triangles();
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t n = triangles[t].neighbors[k];
        if (n == kNoNeighbor || triangles[t].pieces[k] != kNoPiece || plane.touches_frame(t))
          continue;
        if (plane.touches_frame(n)) continue;
        const auto& v = triangles[t].vertices;
        const std::uint32_t d = triangles[n].vertices[triangles[n].corner_opposite(t)];
        const auto& p = figure.points;
        if (reference::in_circle(p[v[0]], p[v[1]], p[v[2]], p[d]) <= 0) continue;
        ++tied;
        if (circles.share(v[0], v[1], v[2], d)) continue;
        EXPECT_LT(depth_in_circle(p[v[0]], p[v[1]], p[v[2]], p[d]), 1e-6);
      }
    }
  });
  EXPECT_GT(tied, 0u);
  EXPECT_LT(10 * with, without);
}

// Points in rows and columns and of regular polygons, as they are and moved by noise as large as
// rounding makes it for atoms some 1000 Å from the origin: the same triangles. Where nothing but
// exact tests decides, they are others.
TEST(PlaneTriangulation, NoiseDoesNotDecideTies) {
  const PointCircles none{PatchBoundary()};
  std::vector<std::vector<PlanePoint>> sets(2);
  for (int i = 0; i < 100; ++i) {
    sets[0].push_back({0.1 * (i % 10), 0.1 * (i / 10)});
    const double angle = 2 * std::numbers::pi * (i % 12) / 12, r = 1 + i / 12;
    sets[1].push_back({0.1 * r * std::cos(angle), 0.1 * r * std::sin(angle)});
  }
  for (const auto& points : sets) {
    const auto triangles = [&](double noise, const PointCircles* circles) {
      Dice dice(11);
      std::vector<PlanePoint> moved = points;
      for (PlanePoint& p : moved) p.x += noise * dice.real(-1, 1), p.y += noise * dice.real(-1, 1);
      PlaneTriangulation plane;
      plane.start(moved, circles);
      insert_points(plane, moved.size());
      return triangles_in_hull(plane);
    };
    EXPECT_EQ(triangles(0, &none), triangles(1e-12, &none));
    EXPECT_NE(triangles(0, nullptr), triangles(1e-12, nullptr));
  }
}

// A patch goes on with a triangulation after pieces were split: the same triangles as from scratch.
TEST(PlaneTriangulation, SplitPiecesAsCgal) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    Figure figure = random_points(dice, 60);
    add_segments(dice, 40, figure);
    figure.enclose();
    PlaneTriangulation plane;
    triangulated(figure, plane);
    PlaneTriangulation::State state;
    plane.save(state);
    plane.start(plane_points(figure), nullptr);
    plane.resume(state, nullptr);
    const auto count = static_cast<std::uint32_t>(figure.segments.size() - 4);
    for (std::uint32_t s = 0; s < count; ++s) {
      const auto [a, b] = figure.segments[s];
      const FlatPoint p = figure.points[a], q = figure.points[b];
      // Beside the middle by less than the distance of other segments, most probably.
      const FlatPoint m{(p[0] + q[0]) / 2 + 1e-7 * (q[1] - p[1]), (p[1] + q[1]) / 2};
      plane.remove_piece(a, b);
      const std::uint32_t v = plane.add_point({m[0], m[1]});
      plane.insert(v, plane.locate({m[0], m[1]}, plane.triangle_at(a)));
      ASSERT_EQ(plane.insert_piece(a, v, s), Outcome::inserted);
      ASSERT_EQ(plane.insert_piece(v, b, s), Outcome::inserted);
      figure.points.push_back(m);
      figure.segments[s] = {a, v};
      figure.segments.push_back({v, b});
    }
    EXPECT_EQ(triangles_in_hull(plane),
              reference::constrained_delaunay(figure.points, figure.segments));
  }
}

// The filters against exact arithmetic: where they give a sign, it is the right one, also for
// points moved by an ulp or so off a common line or circle, at sizes from 1e-30 to 1e15.
TEST(PlanePredicates, AFilteredSignIsTheExactOne) {
  Dice dice(7);
  int decided = 0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::pow(10.0, dice.whole(-30, 15)), shift = dice.one_in(2) ? 0 : scale;
    const double noise = dice.one_in(2) ? 0 : std::pow(10.0, dice.whole(-18, 0));
    FlatPoint p[4];
    for (FlatPoint& q : p) {
      const double angle = dice.real(0, 7);
      const bool line = dice.one_in(3);
      q = {shift + scale * ((line ? angle : std::cos(angle)) + noise * dice.real(-1, 1)),
           shift + scale * ((line ? 0.7 * angle : std::sin(angle)) + noise * dice.real(-1, 1))};
    }
    double largest = 0;
    for (const FlatPoint& q : p) largest = std::max({largest, std::abs(q[0]), std::abs(q[1])});
    const auto at = [&](int k) { return PlanePoint{p[k][0], p[k][1]}; };
    const PlaneErrors errors = PlaneErrors::up_to(largest);
    if (const int sign = filtered_orientation(errors, at(0), at(1), at(2))) {
      ++decided;
      EXPECT_EQ(sign, reference::orientation(p[0], p[1], p[2]));
    }
    if (reference::orientation(p[0], p[1], p[2]) <= 0) continue;
    const CircleTerms terms(at(0), at(1), at(2), at(3));
    for (const double error : {errors.in_circle, terms.error()}) {
      const int sign = plane::sign_beyond(terms.determinant(), error);
      if (sign == 0) continue;
      EXPECT_EQ(sign, reference::in_circle(p[0], p[1], p[2], p[3]));
    }
  }
  EXPECT_GT(decided, 100000);
}

TEST(PlanePredicates, NothingIsDecidedForNan) {
  const PlanePoint p{0, 0}, q{1, 0}, r{0, 1}, nan{std::nan(""), 0};
  const PlaneErrors errors = PlaneErrors::up_to(1);
  EXPECT_EQ(filtered_orientation(errors, p, q, r), 1);
  EXPECT_EQ(filtered_orientation(errors, p, q, nan), 0);
  const CircleTerms terms(p, q, r, nan);
  EXPECT_EQ(plane::sign_beyond(terms.determinant(), terms.error()), 0);
}

}  // namespace
}  // namespace vdwmesh
