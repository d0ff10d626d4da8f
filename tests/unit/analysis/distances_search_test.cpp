// The search for the nearest exposed point and for the nearest triangle against the same without
// its shortcuts, on sets unlike molecules.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/crossings/triangle_runs.hpp"
#include "analysis/distances.hpp"
#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/distances_tree.hpp"
#include "analysis/distances/distances_triangle.hpp"
#include "analysis/distances/exposed_surface.hpp"
#include "analysis/distances/mesh_finder.hpp"
#include "analysis/signed_distance.hpp"
#include "support/dice.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;

constexpr double kFar = std::numeric_limits<double>::infinity();

Vec3d place(Dice& dice, double half) {
  return {dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)};
}

struct Case {
  std::string name;
  std::vector<Sphere> balls;
  std::vector<Vec3d> points;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

// Some points in the box of the balls, some within and around each ball, some far away.
Case with_points(std::string name, std::vector<Sphere> balls, Dice& dice) {
  Case c{std::move(name), std::move(balls), {}};
  const Box box = bounding_box(SphereSet(c.balls));
  const Vec3d middle = 0.5 * (box.lower + box.upper), extent = box.upper - box.lower;
  const double half = 0.5 * std::max({extent.x, extent.y, extent.z});
  for (int i = 0; i < 60; ++i)
    c.points.push_back(middle + place(dice, i % 6 == 0 ? 5 * half : half));
  for (const Sphere& ball : c.balls)
    for (int i = 0; i < 3; ++i) c.points.push_back(ball.center + place(dice, 1.2 * ball.radius));
  return c;
}

// Six balls cover the sphere of a seventh between them, but not its middle.
std::vector<Sphere> covered_together() {
  std::vector<Sphere> balls{{{0, 0, 0}, 2}};
  for (const double side : {-2.0, 2.0}) {
    balls.push_back({{side, 0, 0}, 1.9});
    balls.push_back({{0, side, 0}, 1.9});
    balls.push_back({{0, 0, side}, 1.9});
  }
  return balls;
}

std::vector<Case> cases() {
  Dice dice(11);
  std::vector<Case> all;
  const auto add = [&](const char* name, const std::vector<Sphere>& balls) {
    all.push_back(with_points(name, balls, dice));
  };
  std::vector<Sphere> balls;
  for (int i = 0; i < 40; ++i) balls.push_back({place(dice, 50), dice.real(0.1, 6)});
  add("sparse_gas", balls);
  balls.clear();
  for (int i = 0; i < 25; ++i) balls.push_back({place(dice, 1.5), dice.real(0.3, 1.5)});
  add("crowd", balls);
  balls.clear();
  for (int i = 0; i < 36; ++i)
    balls.push_back({{1.25 * (i % 3), 1.25 * (i / 3 % 3), 1.25 * (i / 9)}, 0.75});
  add("lattice", balls);
  balls.clear();
  for (int i = 0; i < 40; ++i)
    balls.push_back({{0.9 * i, std::sin(0.7 * i), std::cos(0.7 * i)}, 0.8});
  add("chain", balls);
  balls.clear();
  for (int i = 0; i < 60; ++i) {  // on a sphere of radius 3: a void inside
    const double z = 1 - (2 * i + 1.0) / 60, angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double s = std::sqrt(1 - z * z);
    balls.push_back({{3 * s * std::cos(angle), 3 * s * std::sin(angle), 3 * z}, 1.1});
  }
  add("void", balls);
  balls.assign(1, {{0, 0, 0}, 1000});
  for (int i = 0; i < 40; ++i) {
    const Vec3d out = place(dice, 1);
    balls.push_back({(dice.real(999.5, 1000.5) / norm(out)) * out, dice.real(0.2, 1)});
  }
  add("one_huge_many_tiny", balls);
  balls.clear();
  for (int i = 0; i < 16; ++i) {
    const Vec3d site{1e13 * (i / 2 % 4), -1e13 * (i / 2 % 3), 0};
    balls.push_back({site + Vec3d{i % 2 * 0.75, 0, 0}, 1});
  }
  add("pairs_a_kilometre_apart", balls);
  balls.clear();
  for (int i = 0; i < 20; ++i) balls.push_back({{0.01 * i, 0, 0}, 2 - 0.011 * i});
  balls.push_back(balls[0]);
  balls.push_back({{4, 0, 0}, 1});
  add("nested_and_twice", balls);
  add("covered_together", covered_together());
  return all;
}

double length(const Vec3d& v) { return std::hypot(v.x, v.y, v.z); }

// The distance by its definition: the nearest point of each sphere, of each two spheres' circle and
// all points on three spheres, of those that no ball covers.
class Oracle {
 public:
  explicit Oracle(std::vector<Sphere> balls) : balls_(std::move(balls)) {
    // Of balls that are equal one is enough.
    for (std::size_t i = balls_.size(); i-- > 0;)
      for (std::size_t j = 0; j < i; ++j)
        if (balls_[i].center == balls_[j].center && balls_[i].radius == balls_[j].radius) {
          balls_.erase(balls_.begin() + static_cast<std::ptrdiff_t>(i));
          break;
        }
  }

  double distance(const Vec3d& p) const {
    double best = kFar;
    for (std::size_t i = 0; i < balls_.size(); ++i) {
      const Sphere& a = balls_[i];
      const Vec3d from = p - a.center;  // all below is relative to this centre
      consider(i, (a.radius / length(from)) * from, from, best);
      for (std::size_t j = 0; j < i; ++j) {
        const std::optional<Circle> circle = circle_of(a, balls_[j]);
        if (!circle) continue;
        const Vec3d off = from - circle->middle;
        const Vec3d radial = off - dot(off, circle->axis) * circle->axis;
        consider(i, circle->middle + (circle->radius / length(radial)) * radial, from, best);
        for (std::size_t k = 0; k < j; ++k) corners(i, *circle, balls_[k], from, best);
      }
    }
    return best;
  }

 private:
  struct Circle {
    Vec3d middle, axis;
    double radius;
  };

  static std::optional<Circle> circle_of(const Sphere& a, const Sphere& b) {
    const Vec3d to = b.center - a.center;
    const double d = length(to);
    const double along = (d + (a.radius - b.radius) * (a.radius + b.radius) / d) / 2;
    const double square = (a.radius - along) * (a.radius + along);
    if (d == 0 || !(square > 0)) return std::nullopt;
    const Vec3d axis = (1 / d) * to;
    return Circle{along * axis, axis, std::sqrt(square)};
  }

  // Where the circle meets the sphere of `c`: on the plane of points whose power to both is equal.
  void corners(std::size_t i, const Circle& circle, const Sphere& c, const Vec3d& from,
               double& best) const {
    const Vec3d to = c.center - balls_[i].center;
    const double r = balls_[i].radius;
    const double level = (dot(to, to) + (r - c.radius) * (r + c.radius)) / 2;  // dot(to, q)
    const Vec3d u = to - dot(to, circle.axis) * circle.axis;
    const double slope = length(u);
    if (!(slope > 0)) return;
    const double cosine = (level - dot(to, circle.middle)) / (slope * circle.radius);
    if (!(std::abs(cosine) < 1)) return;
    const Vec3d first = (1 / slope) * u, second = cross(circle.axis, first);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    for (const double side : {sine, -sine})
      consider(i, circle.middle + circle.radius * (cosine * first + side * second), from, best);
  }

  // A point counts as covered from kExposureTolerance radii on.
  void consider(std::size_t i, const Vec3d& q, const Vec3d& from, double& best) const {
    for (std::size_t k = 0; k < balls_.size(); ++k) {
      if (k == i) continue;
      const double gap = length(q - (balls_[k].center - balls_[i].center)) - balls_[k].radius;
      if (gap < -kExposureTolerance * balls_[i].radius) return;
    }
    best = std::min(best, length(q - from));
  }

  std::vector<Sphere> balls_;
};

class DistanceSearch : public ::testing::TestWithParam<Case> {};

Box world_of(const Case& c) {
  Box world = bounding_box(SphereSet(c.balls));
  for (const Vec3d& p : c.points)
    for (int axis = 0; axis < 3; ++axis) {
      world.lower[axis] = std::min(world.lower[axis], p[axis]);
      world.upper[axis] = std::max(world.upper[axis], p[axis]);
    }
  return world;
}

// The formula of surface_search.hpp over all patches, without a tree and without shortcuts.
double unpruned_distance(const ExposedSurface& surface, const Vec3d& p) {
  double gap = kFar, squared = kFar;
  for (const Patch& patch : surface.searched()) {
    gap = std::min(gap, gap_of(patch.ball, p));
    double alone = kFar;
    update_nearest(patch, p, alone);
    squared = std::min(squared, alone);
  }
  return gap >= 0 ? gap : -std::sqrt(std::max(squared, gap * gap));
}

TEST_P(DistanceSearch, FindsTheNearestExposedPoint) {
  const Case& c = GetParam();
  const ExposedSurface surface{SphereSet(c.balls)};
  const SurfaceFinder finder(surface, world_of(c));
  const Oracle oracle(c.balls);
  // Where spheres meet at a flat angle, points within the exposure tolerance of a border decide: Å,
  // for lengths of an ångström some 10⁴ tolerances. And some roundings of the distance.
  constexpr double kBorder = 1e-6, kRoundings = 1e-14;
  for (const Vec3d& p : c.points) {
    double found = 0;
    finder.find(std::span(&p, 1), &found);
    ASSERT_EQ(found, unpruned_distance(surface, p)) << p.x << ' ' << p.y << ' ' << p.z;
    const double distance = std::abs(found);
    ASSERT_NEAR(distance, oracle.distance(p), kBorder + kRoundings * distance)
        << p.x << ' ' << p.y << ' ' << p.z;
    const bool inside = std::any_of(c.balls.begin(), c.balls.end(), [&](const Sphere& ball) {
      return length(p - ball.center) < ball.radius;
    });
    // On the surface, rounding decides.
    if (distance > kBorder + kRoundings * length(p)) {
      ASSERT_EQ(found < 0, inside) << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
}

// In the middle only the ball without exposed points covers. The nearest exposed points are the
// outer ones of those that three balls have in common: t (1, 1, 1) with (2 - t)² + 2 t² = 1.9².
TEST(ExposedSurface, ABallThatOthersCoverTogether) {
  const SphereSet balls(covered_together());
  const double t = (4 + std::sqrt(16 - 12 * (4 - 1.9 * 1.9))) / 6;
  const std::vector<double> found = signed_distances(std::vector<Vec3d>{{0, 0, 0}}, balls);
  EXPECT_NEAR(found[0], -std::sqrt(3.0) * t, 1e-14);
}

// The centre of that ball is in no cover, but it is no exposed point's foot either: it is farther
// from the surface than the points beside it, and raises the maximum after them.
TEST(SurfaceFinder, TheCentreOfABallThatOthersCoverTogetherRaisesTheMaximum) {
  const SphereSet balls(covered_together());
  const ExposedSurface surface(balls);
  std::vector<Vec3d> points(16, Vec3d{0.05, 0.01, 0.02});
  points.push_back({0, 0, 0});
  const SurfaceFinder finder(surface, box_around(bounding_box(balls), points));
  std::vector<double> found(points.size());
  finder.find(points, found.data());
  ASSERT_GT(std::abs(found.back()), std::abs(found.front()) + 0.01);
  EXPECT_EQ(finder.largest_distance(points, 0), std::abs(found.back()));
}

// Neither the points that are searched together nor the patch that is measured first changes a bit:
// groups of neighbours, groups of points from everywhere, and single points with every hint.
TEST_P(DistanceSearch, IsTheSameInGroupsAndWithAnyHint) {
  const Case& c = GetParam();
  const ExposedSurface surface{SphereSet(c.balls)};
  const SurfaceFinder finder(surface, world_of(c));
  std::vector<Vec3d> points = c.points;
  Dice dice(13);
  for (const Vec3d& p : c.points)  // neighbours, in groups that do not begin with them
    for (int i = 0; i < 5; ++i) points.push_back(p + place(dice, 0.01));
  const SurfaceFinder wide(surface, {{-1e15, -1e15, -1e15}, {1e15, 1e15, 1e15}});
  std::vector<double> together(points.size()), in_wide(points.size());
  finder.find(points, together.data());
  wide.find(points, in_wide.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_EQ(together[i], unpruned_distance(surface, points[i]));
    ASSERT_EQ(in_wide[i], together[i]);
    for (std::uint32_t hint = 0; hint < surface.searched().size(); hint += 7) {
      const LeastGap nearest = find_least_gap(finder.view(), points[i], hint);
      ASSERT_EQ(signed_distance(finder.view(), points[i], nearest), together[i]) << hint;
    }
  }
}

// The largest distance of points as the maximum of all distances, from any bound on: points of
// everywhere, and walks near the surface, where nearly every point is passed over. For a bound that
// one point exceeds by a rounding, that point must be found.
TEST_P(DistanceSearch, TheLargestDistanceIsThatOfAllPoints) {
  const Case& c = GetParam();
  const ExposedSurface surface{SphereSet(c.balls)};
  Case all = c;
  Dice dice(15);
  for (std::size_t i = 0; i < c.balls.size(); ++i) {
    const Sphere& ball = c.balls[i];
    const Vec3d out = place(dice, 1);
    Vec3d p = ball.center + (ball.radius / length(out)) * out;
    for (int k = 0; k < 40; ++k) all.points.push_back(p = p + place(dice, 0.05 * ball.radius));
  }
  const Box world = world_of(all);
  const SurfaceFinder finder(surface, world);
  std::vector<double> found(all.points.size());
  finder.find(all.points, found.data());
  for (double& distance : found) distance = std::abs(distance);
  for (const std::size_t run : {1, 7, 40, 333}) {
    for (std::size_t first = 0; first < found.size(); first += run) {
      const std::size_t count = std::min(run, found.size() - first);
      const auto points = std::span(all.points).subspan(first, count);
      const auto distances = std::span(found).subspan(first, count);
      const double largest = std::ranges::max(distances);
      std::vector<double> sorted(distances.begin(), distances.end());
      std::ranges::sort(sorted);
      for (const double least : {0.0, sorted[count / 2], std::nextafter(largest, 0.0), largest,
                                 std::nextafter(largest, kFar)}) {
        ASSERT_EQ(finder.largest_distance(points, least), std::max(least, largest))
            << first << ' ' << run;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, DistanceSearch, ::testing::ValuesIn(cases()),
                         [](const auto& each) { return each.param.name; });

// Triangles of every size, thin ones and points too.
std::vector<std::array<Vec3d, 3>> triangles_about(const std::vector<Sphere>& balls, Dice& dice) {
  std::vector<std::array<Vec3d, 3>> triangles;
  for (const Sphere& ball : balls)
    for (int i = 0; i < 4; ++i) {
      const Vec3d a = ball.center + place(dice, ball.radius);
      const double size = ball.radius * std::pow(10, dice.real(-6, 0.5));
      const Vec3d b = dice.one_in(8) ? a : a + place(dice, size);
      triangles.push_back({a, b, dice.one_in(8) ? a + 2.0 * (b - a) : a + place(dice, size)});
    }
  return triangles;
}

TEST_P(DistanceSearch, FindsTheNearestTriangle) {
  const Case& c = GetParam();
  Dice dice(12);
  const auto triangles = triangles_about(c.balls, dice);
  Box world{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto add = [](Box& box, const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis) {
      box.lower[axis] = std::min(box.lower[axis], p[axis]);
      box.upper[axis] = std::max(box.upper[axis], p[axis]);
    }
  };
  const auto box_of = [&](std::uint32_t t) {
    Box box{triangles[t][0], triangles[t][0]};
    for (const Vec3d& p : triangles[t]) add(box, p);
    return box;
  };
  for (const auto& t : triangles)
    for (const Vec3d& p : t) add(world, p);
  for (const Vec3d& p : c.points) add(world, p);
  const BoxTree tree(static_cast<std::uint32_t>(triangles.size()), world, box_of);
  const auto squared_to = [&](const Vec3d& p, std::uint32_t t) {
    return squared_distance_to_triangle(p, triangles[t][0], triangles[t][1], triangles[t][2]);
  };
  for (const Vec3d& p : c.points) {
    double expected = kFar, found = kFar;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      expected = std::min(expected, squared_to(p, t));
    visit_nearest(tree.view(), tree.view().query(p), found,
                  [&](std::uint32_t t, double& best) { best = std::min(best, squared_to(p, t)); });
    ASSERT_EQ(found, expected) << p.x << ' ' << p.y << ' ' << p.z;
  }
}

void add_triangle(IndexedMesh& mesh, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
  for (const Vec3d& p : {a, b, c}) mesh.positions.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
}

// Walks through the box in short steps, so that groups list nodes and points examine them, with
// jumps between the walks. Against all triangles, bit for bit. If the triangles are divided, their
// children are searched four at a time, and the last of all is left over.
void search_along_walks(const Case& c, bool divided) {
  Dice dice(14);
  IndexedMesh mesh;
  for (int copy = 0; copy < (divided ? 1 : 4); ++copy)
    for (const auto& [a, b, d] : triangles_about(c.balls, dice)) {
      if (!divided) {
        add_triangle(mesh, a, b, d);
        continue;
      }
      const Vec3d ab = 0.5 * (a + b), bd = 0.5 * (b + d), da = 0.5 * (d + a);
      add_triangle(mesh, a, ab, da);
      add_triangle(mesh, b, bd, ab);
      add_triangle(mesh, d, da, bd);
      add_triangle(mesh, ab, bd, da);
    }
  if (divided) {
    ASSERT_EQ(triangles_together(mesh), kTriangleRun);
    add_triangle(mesh, c.points[0], c.points[1], c.points[2]);
  }
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < c.points.size(); i += 3) {
    const double step = c.balls[i % c.balls.size()].radius * std::pow(10, dice.real(-4, -0.5));
    Vec3d p = c.points[i];
    for (int k = 0; k < 45; ++k) points.push_back(p = p + place(dice, step));
  }
  Box world = world_of(c);
  const auto add = [&](const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis) {
      world.lower[axis] = std::min(world.lower[axis], p[axis]);
      world.upper[axis] = std::max(world.upper[axis], p[axis]);
    }
  };
  for (const Vec3d& p : mesh.positions) add(p);
  for (const Vec3d& p : points) add(p);
  std::vector<double> found(points.size());
  const MeshFinder finder(mesh, world);
  finder.find(points, found.data());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double expected = kFar;
    for (const auto& [a, b, d] : mesh.triangles)
      expected =
          std::min(expected, squared_distance_to_triangle(points[i], mesh.positions[a],
                                                          mesh.positions[b], mesh.positions[d]));
    ASSERT_EQ(found[i], std::sqrt(expected)) << i;
  }
  for (std::size_t first = 0; first < points.size(); first += 31) {
    const std::size_t count = std::min<std::size_t>(31, points.size() - first);
    const auto run = std::span(points).subspan(first, count);
    const double largest = std::ranges::max(std::span(found).subspan(first, count));
    for (const double least : {0.0, std::nextafter(largest, 0.0), std::nextafter(largest, kFar)}) {
      ASSERT_EQ(finder.largest_distance(run, least), std::max(least, largest)) << first;
    }
  }
}

TEST_P(DistanceSearch, FindsTheNearestTriangleAlongWalks) { search_along_walks(GetParam(), false); }
TEST_P(DistanceSearch, FindsTheNearestOfDividedTrianglesAlongWalks) {
  search_along_walks(GetParam(), true);
}

// Points are sorted by the cells of a cube around them, which may be a point, or far longer than
// what doubles tell apart beside its ends.
TEST(MeshFinder, MeasuresPointsOfAnyExtent) {
  const IndexedMesh mesh = testing::icosphere(2);
  const auto squared_to_mesh = [&](const Vec3d& p) {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b, c] : mesh.triangles)
      least = std::min(least, squared_distance_to_triangle(p, mesh.positions[a], mesh.positions[b],
                                                           mesh.positions[c]));
    return least;
  };
  const std::vector<Vec3d> same(20, Vec3d{0.3, 0.2, 1.5});
  const std::vector<Vec3d> tiny{{0, 0, 0}, {5e-324, 0, 0}, {0, 1e-310, 0}};
  const std::vector<Vec3d> wide{{1e6, 0, 0}, {0.5, 0.5, 2}, {-1e6, 1, 0}, {0.5, 0.5, 2.0000001}};
  for (const std::vector<Vec3d>& points : {same, tiny, wide, std::vector<Vec3d>{}}) {
    const MeshFinder finder(mesh, {{-2e6, -2e6, -2e6}, {2e6, 2e6, 2e6}});
    std::vector<double> found(points.size());
    finder.find(points, found.data());
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(found[i], std::sqrt(squared_to_mesh(points[i]))) << i << " of " << points.size();
  }
}

// Distances have no sign: they are the same for a mesh inside out, and grow by the way that a mesh
// is moved off.
TEST(Distances, OfMeshesInsideOutAndFarOff) {
  const SphereSet ball({{{0, 0, 0}, 1}});
  const IndexedMesh mesh = testing::scaled(testing::icosphere(3), 1.1);
  const MeshDistances out = distances(mesh, ball), in = distances(testing::reversed(mesh), ball);
  const double errors = std::hypot(out.mesh_to_surface.mean_error, in.mesh_to_surface.mean_error);
  EXPECT_NEAR(in.mesh_to_surface.mean, out.mesh_to_surface.mean, 5 * errors);
  EXPECT_NEAR(in.surface_to_mesh.mean, out.surface_to_mesh.mean, 1e-12);
  for (const double off : {1e4, 1e8, 1e12}) {
    const MeshDistances far = distances(testing::translated(mesh, {off, 0, 0}), ball);
    // Between points of balls of radius 1.1 and 1; a position is rounded to 2^-53 of it.
    const double slack = 2.2 + off * 1e-15;
    for (const DistanceStatistics& d : {far.mesh_to_surface, far.surface_to_mesh})
      for (const double figure : {d.mean, d.rms, d.max}) EXPECT_NEAR(figure, off, slack);
  }
}

}  // namespace
}  // namespace vdwmesh
