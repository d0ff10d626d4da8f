// Contract of excluded_distance_bounds(): closed forms of polyhedra around and inside of a ball,
// and what samples of excluded_distances() find on molecules, which is another search.
#include "excluded/excluded_bounds.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "excluded/excluded_distances.hpp"
#include "excluded/excluded_mesher.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kGap = 0.05, kProbe = 1.4;
constexpr double kRounded = 1e-8;  // Å: the finder's tolerance, and roundings

// Its faces, then one face less for each that is left out.
IndexedMesh octahedron(double radius, std::size_t left_out = 0) {
  IndexedMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {radius, -radius}) {
      Vec3d p{0, 0, 0};
      p[axis] = sign;
      mesh.positions.push_back(p);
    }
  }
  std::vector<Triangle> faces;
  for (std::uint32_t x = 0; x < 2; ++x) {
    for (std::uint32_t y = 2; y < 4; ++y) {
      for (std::uint32_t z = 4; z < 6; ++z) {
        const bool even = (x + y + z) % 2 == 0;
        faces.push_back(even ? Triangle{x, y, z} : Triangle{x, z, y});
      }
    }
  }
  for (std::size_t t = left_out; t < faces.size(); ++t) mesh.triangles.push_back(faces[t]);
  return mesh;
}

IndexedMesh cube(double half) {
  IndexedMesh mesh;
  for (int i = 0; i < 8; ++i) {
    const auto at = [&](int bit) { return (i >> bit & 1) != 0 ? half : -half; };
    mesh.positions.push_back({at(0), at(1), at(2)});
  }
  for (const auto& [a, b, c, d] : std::vector<std::array<std::uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  return mesh;
}

void expect_around(const DistanceBounds& found, double exact) {
  EXPECT_LE(found.lower, exact + kRounded);
  EXPECT_GE(found.upper, exact - kRounded);
  EXPECT_LE(found.upper, (1 + kGap) * exact + kRounded);
}

const SphereSet kBall({{{0, 0, 0}, 2}});

// The middle of a face of an octahedron is at r / √3, and the farthest point of the sphere above
// it.
TEST(ExcludedBounds, AnOctahedronInABall) {
  const HausdorffBounds found = excluded_distance_bounds(octahedron(2), kBall, kProbe);
  const double exact = 2 * (1 - 1 / std::sqrt(3.0));
  expect_around(found.mesh_to_surface, exact);
  expect_around(found.surface_to_mesh, exact);
  EXPECT_EQ(found.upper(), std::max(found.mesh_to_surface.upper, found.surface_to_mesh.upper));
}

// Without one face the sphere's point above it is nearest to the middle of an edge, (1, 1, 0) r
// / 2.
TEST(ExcludedBounds, AHoleIsFarFromTheSurface) {
  const HausdorffBounds found = excluded_distance_bounds(octahedron(2, 1), kBall, kProbe);
  const double along = 1 / std::sqrt(3.0);
  expect_around(found.mesh_to_surface, 2 * (1 - along));
  expect_around(found.surface_to_mesh, 2 * std::hypot(along - 0.5, along - 0.5, along));
}

// A cube around the ball: its corners are at √3 r; the sphere's farthest point is at (1, 1, 1).
TEST(ExcludedBounds, ACubeAroundABall) {
  const HausdorffBounds found = excluded_distance_bounds(cube(2), kBall, kProbe);
  expect_around(found.mesh_to_surface, 2 * (std::sqrt(3.0) - 1));
  expect_around(found.surface_to_mesh, 2 * (1 - 1 / std::sqrt(3.0)));
}

TEST(ExcludedBounds, StopsAtALimitWithABoundThatHolds) {
  const HausdorffBounds found =
      excluded_distance_bounds(octahedron(2), kBall, kProbe, {.most_points = 10});
  const double exact = 2 * (1 - 1 / std::sqrt(3.0));
  for (const DistanceBounds& b : {found.mesh_to_surface, found.surface_to_mesh}) {
    EXPECT_LE(b.lower, exact + kRounded);
    EXPECT_GE(b.upper, exact);
  }
  EXPECT_GT(found.surface_to_mesh.upper, (1 + kGap) * exact);
}

// No sample is above the bound, and the bound is near to the largest of many.
void expect_samples_below(const IndexedMesh& mesh, const SphereSet& atoms, double probe,
                          double samples_per_area) {
  const HausdorffBounds bounds = excluded_distance_bounds(mesh, atoms, probe);
  const MeshDistances sampled =
      excluded_distances(mesh, atoms, probe, {.samples_per_area = samples_per_area});
  for (const auto& [bound, most] :
       {std::pair(bounds.mesh_to_surface, sampled.mesh_to_surface.max),
        std::pair(bounds.surface_to_mesh, sampled.surface_to_mesh.max)}) {
    EXPECT_LE(most, bound.upper);
    EXPECT_LE(bound.upper, 1.1 * most + kRounded);
    EXPECT_LE(bound.lower, bound.upper);
  }
}

// Rings, spindles with cusps, and three balls whose probes meet in a crease.
TEST(ExcludedBounds, TwoAndThreeBalls) {
  const auto mesh_of = [](const SphereSet& atoms) {
    return mesh_excluded(atoms, {.probe = kProbe, .edge_length = 0.8}).mesh;
  };
  for (const double distance : {2.0, 4.7, 5.9, 6.2}) {
    SCOPED_TRACE(distance);
    const SphereSet pair({{{0.3, -0.2, 0.1}, 1.7}, {{0.3 + distance, -0.2, 0.1}, 1.5}});
    expect_samples_below(mesh_of(pair), pair, kProbe, 3000);
  }
  for (const double side : {3.0, 4.2, 4.8}) {
    SCOPED_TRACE(side);
    const SphereSet triple(
        {{{0, 0, 0}, 1.7}, {{side, 0, 0}, 1.5}, {{0.48 * side, 0.87 * side, 0.1}, 1.6}});
    expect_samples_below(mesh_of(triple), triple, kProbe, 3000);
  }
}

TEST(ExcludedBounds, Molecules) {
  VDWMESH_NEEDS_SHARED("reference/1L2Y.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1L2Y.xyzr"));
  for (const double probe : {0.7, 1.4}) {
    SCOPED_TRACE(probe);
    const IndexedMesh mesh = mesh_excluded(atoms, {.probe = probe, .edge_length = 0.7}).mesh;
    expect_samples_below(mesh, atoms, probe, 100);
  }
}

// A hollow cube of balls, none in special position: the mesh of the exterior surface lacks the wall
// of the cavity.
TEST(ExcludedBounds, CavitiesCountOnlyInTheCompleteSurface) {
  std::vector<Sphere> balls;
  for (int i = 0; i < 27; ++i) {
    const Vec3d at{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0};
    const Vec3d aside{0.01 * (i % 5), 0.01 * (i % 7), 0.01 * (i % 4)};
    if (i != 13) balls.push_back({2.6 * at + aside, 1.6});
  }
  const SphereSet cage(balls);
  const IndexedMesh outside =
      mesh_excluded(cage, {.probe = 0.8, .edge_length = 0.5, .exterior = true}).mesh;
  const HausdorffBounds of_exterior =
      excluded_distance_bounds(outside, cage, 0.8, {}, ExcludedPart::exterior);
  EXPECT_LT(of_exterior.upper(), 0.3);
  // The wall is less than 1.1 Å from the middle, and the exterior surface more than 3 Å.
  const HausdorffBounds of_all = excluded_distance_bounds(outside, cage, 0.8);
  EXPECT_LT(of_all.mesh_to_surface.upper, 0.3);
  EXPECT_GT(of_all.surface_to_mesh.lower, 1.9);
}

TEST(ExcludedBounds, SameBitsOnAnyThreads) {
  const SphereSet pair({{{0.3, -0.2, 0.1}, 1.7}, {{5, -0.2, 0.1}, 1.5}});
  const IndexedMesh mesh = mesh_excluded(pair, {.probe = kProbe, .edge_length = 0.3}).mesh;
  const auto figures = [&] {
    const HausdorffBounds b = excluded_distance_bounds(mesh, pair, kProbe);
    return std::vector<double>{b.mesh_to_surface.lower, b.mesh_to_surface.upper,
                               b.surface_to_mesh.lower, b.surface_to_mesh.upper};
  };
  const std::vector<double> many = figures();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many, figures());
}

TEST(ExcludedBounds, RefusesWrongArguments) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double gap : {0.0, -1.0, nan}) {
    EXPECT_THROW(excluded_distance_bounds(octahedron(2), kBall, kProbe, {.gap = gap}),
                 InvalidInput);
  }
  EXPECT_THROW(excluded_distance_bounds(octahedron(2), kBall, 0), InvalidInput);
  EXPECT_THROW(excluded_distance_bounds(octahedron(2), SphereSet(), kProbe), InvalidInput);
  EXPECT_THROW(excluded_distance_bounds(IndexedMesh(), kBall, kProbe), InvalidInput);
  EXPECT_THROW(excluded_distance_bounds(octahedron(nan), kBall, kProbe), InvalidInput);
  EXPECT_THROW(excluded_distance_bounds(octahedron(2), kBall, kProbe, {.memory_limit = 1000}),
               LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh::testing
