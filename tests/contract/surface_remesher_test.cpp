// Contract of remesh_excluded(): closed oriented manifolds at about the density asked for, of the
// exact topology, without crossings, whose vertices lie on the exact surface. Topology and area
// come from excluded_measures(), distances from excluded_signed_distances(); neither sees a mesh.
#include "remesh/surface_remesher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "excluded/excluded_bounds.hpp"
#include "excluded/excluded_distances.hpp"
#include "excluded/excluded_measures.hpp"
#include "excluded/excluded_mesher.hpp"
#include "refine/patch_refiner.hpp"
#include "spheres/directions.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kOffSurface = 1e-9;  // Å: what the remesher promises

ExcludedSurface exact_surface(const SphereSet& atoms, double probe, bool exterior) {
  const ExcludedMeasures measures =
      excluded_measures(atoms, {.probe = probe, .shells = true, .exterior = exterior});
  return exterior ? *measures.exterior : measures.complete;
}

double farthest(const IndexedMesh& mesh, const SphereSet& atoms, double probe, ExcludedPart part) {
  const std::span<const Vec3d> points(mesh.positions.data(), mesh.vertex_count());
  double most = 0;
  for (const double d : excluded_signed_distances(points, atoms, probe, nullptr, part)) {
    most = std::max(most, std::isnan(d) ? HUGE_VAL : std::abs(d));
  }
  return most;
}

// The least rise of the distance along the normal of a triangle, through its middle: the cosine of
// the angle between that normal and the surface's.
double least_rise(const IndexedMesh& mesh, const SphereSet& atoms, double probe) {
  constexpr double kStep = 1e-4;  // Å
  std::vector<Vec3d> points;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
    const Vec3d n = cross(b - a, c - a);
    const Vec3d step = (kStep / norm(n)) * n, middle = (1.0 / 3) * (a + b + c);
    points.push_back(middle - step);
    points.push_back(middle + step);
  }
  const std::vector<double> d = excluded_signed_distances(points, atoms, probe);
  double least = 1;
  for (std::size_t i = 0; i < d.size(); i += 2) {
    least = std::min(least, (d[i + 1] - d[i]) / (2 * kStep));
  }
  return least;
}

// Everything that holds for every mesh.
void expect_sound(const RemeshedSurface& made, const SphereSet& atoms, double probe,
                  bool exterior) {
  const ExcludedSurface exact = exact_surface(atoms, probe, exterior);
  const MeshTopology found = topology(made.mesh);
  EXPECT_TRUE(found.closed && found.manifold && found.oriented);
  EXPECT_EQ(found.euler_characteristic, exact.topology->euler_characteristic);
  EXPECT_EQ(found.shells, exact.topology->shells.size());
  EXPECT_EQ(found.isolated_vertices, 0u);
  EXPECT_EQ(self_intersections(made.mesh), 0u);
  EXPECT_LE(
      farthest(made.mesh, atoms, probe, exterior ? ExcludedPart::exterior : ExcludedPart::complete),
      kOffSurface);
  EXPECT_EQ(made.triangle_patch.size(), made.mesh.triangle_count());
  EXPECT_EQ(made.vertex_patch.size(), made.mesh.vertex_count());
  EXPECT_NO_THROW(check_patches(made));
}

RemeshedSurface expect_remeshed(const SphereSet& atoms, double probe, double density,
                                bool exterior = false) {
  RemeshedSurface made = remesh_excluded(
      atoms,
      {.probe = probe, .edge_length = edge_length_of_density(density), .exterior = exterior});
  expect_sound(made, atoms, probe, exterior);
  return made;
}

SphereSet pair_of(double radius, double distance) {
  return SphereSet({{{0.3, -0.2, 0.1}, radius}, {{0.3 + distance, -0.2, 0.1}, radius}});
}
// Two balls of 1.5 Å whose saddle for a probe of 1.4 Å comes this near to its axis.
SphereSet pair_with_waist(double waist) {
  const double ring = 1.4 + waist;
  return pair_of(1.5, 2 * std::sqrt(2.9 * 2.9 - ring * ring));
}

// Seen from the centre of a sphere of radius r, a flat element at the angle θ from the normal of an
// equilateral triangle of edge L, whose plane is at h, has h² / (r² cos³ θ) of the sphere's area.
// With h² = r² - L² / 3 and the mean L² / 12 r² of θ² the triangle loses 5 L² / 24 r², and N of
// them on the area A lose 5 A / (6 √3 N r²). No inscribed mesh of N triangles loses less (L. Fejes
// Tóth).
TEST(SurfaceRemesher, TheAreaOfABallFallsShortAsOneByN) {
  const double radius = 2, exact = 4 * std::numbers::pi * radius * radius;
  const SphereSet ball({{{1, 2, 3}, radius}});
  for (const double density : {2.0, 8.0, 32.0}) {
    SCOPED_TRACE(density);
    const RemeshedSurface made = expect_remeshed(ball, 1.4, density);
    const double count = static_cast<double>(made.mesh.triangle_count());
    EXPECT_NEAR(count / exact / density, 1, 0.25);
    const double loss = 1 - measures(made.mesh).area / exact;
    const double ideal = 5 * exact / (6 * std::sqrt(3.0) * count * radius * radius);
    EXPECT_GT(loss, ideal * 0.97);  // terms of fourth order: some 1/N of it
    EXPECT_LT(loss, ideal * 1.15);
    EXPECT_GT(quality(made.mesh).min_angle_deg.min, 25);
  }
}

TEST(SurfaceRemesher, TwoBallsApartRingsAndSpindles) {
  for (const double distance : {0.5, 2.0, 3.2, 4.2, 4.7, 5.2, 5.9, 6.2}) {
    for (const double density : {0.5, 2.0, 16.0}) {
      SCOPED_TRACE(::testing::Message() << distance << ", " << density);
      const SphereSet pair({{{0.3, -0.2, 0.1}, 1.7}, {{0.3 + distance, -0.2, 0.1}, 1.5}});
      expect_remeshed(pair, 1.4, density);
    }
  }
}

// The neck keeps its three vertices or more, however thin it is.
TEST(SurfaceRemesher, ThinWaists) {
  for (const double waist : {1e-1, 1e-2, 1e-3, 1e-5, -1e-3, -1e-1}) {
    for (const double density : {1.0, 8.0}) {
      SCOPED_TRACE(::testing::Message() << waist << ", " << density);
      expect_remeshed(pair_with_waist(waist), 1.4, density);
    }
  }
}

// Creases between two low probes, and of more atoms around them.
TEST(SurfaceRemesher, ThreeBallsWithACrease) {
  for (const double side : {3.0, 4.2, 4.8, 5.2}) {
    for (const double density : {0.5, 2.0, 16.0}) {
      SCOPED_TRACE(::testing::Message() << side << ", " << density);
      const SphereSet triple(
          {{{0, 0, 0}, 1.7}, {{side, 0, 0}, 1.5}, {{0.48 * side, 0.87 * side, 0.1}, 1.6}});
      expect_remeshed(triple, 1.4, density);
    }
  }
}

// A cage of balls around a cavity: the complete surface has its wall, the exterior one has not.
TEST(SurfaceRemesher, ACavityKeepsItsWall) {
  std::vector<Sphere> balls;
  for (const Vec3d& u :
       std::vector<Vec3d>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    balls.push_back({4.0 * u, 2.5});
  }
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) balls.push_back({{2.6 * x, 2.6 * y, 2.6 * z}, 2.0});
    }
  }
  const SphereSet cage(balls);
  for (const double density : {0.5, 4.0}) {
    SCOPED_TRACE(density);
    const RemeshedSurface complete = expect_remeshed(cage, 1.0, density);
    EXPECT_EQ(topology(complete.mesh).voids, 1u);
    EXPECT_EQ(topology(expect_remeshed(cage, 1.0, density, true).mesh).voids, 0u);
  }
}

// The mesh along the curves is not found with long edges, so shorter ones are tried. Far balls keep
// the frame, and with it the rounding, of the molecule in which this was seen.
TEST(SurfaceRemesher, CurvesThatLongEdgesDoNotTellApart) {
  const SphereSet atoms({{{-1.227, -34.257, 8.755}, 1.55},
                         {{5.883, 11.524, -26.476}, 1.7},
                         {{11.056, 16.896, -2.182}, 1.7},
                         {{6.750, 13.708, -0.486}, 1.7},
                         {{8.212, 13.645, -0.243}, 1.7},
                         {{6.183, 17.873, -3.872}, 1.7},
                         {{6.306, 15.583, -5.061}, 1.7}});
  EXPECT_THROW(mesh_excluded(atoms, {.probe = 1.4, .edge_length = 0.7}), CurvesTooClose);
  expect_remeshed(atoms, 1.4, 2);
}

TEST(SurfaceRemesher, TrianglesFaceOutward) {
  for (const double density : {1.0, 4.0}) {
    const SphereSet triple({{{0, 0, 0}, 1.7}, {{4.2, 0, 0}, 1.5}, {{2, 3.6, 0.1}, 1.6}});
    const RemeshedSurface made = expect_remeshed(triple, 1.4, density);
    EXPECT_GT(least_rise(made.mesh, triple, 1.4), 0);
  }
}

TEST(SurfaceRemesher, Molecules) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  const SphereSet atoms = read_xyzr(shared_path("reference/1CRN.xyzr"));
  struct Case {
    double probe, density;
  };
  for (const auto& [probe, density] : {Case{0.7, 8}, Case{1.4, 0.5}, Case{1.4, 2}, Case{3, 1}}) {
    SCOPED_TRACE(::testing::Message() << probe << ", " << density);
    const RemeshedSurface made = expect_remeshed(atoms, probe, density);
    const double area = exact_surface(atoms, probe, false).area;
    const std::size_t count = made.mesh.triangle_count();
    EXPECT_GT(static_cast<double>(count) / area, 0.8 * density);
    // Edges longer than the probe's radius leave thin parts of the surface as they are.
    if (edge_length_of_density(density) > probe) continue;
    EXPECT_LT(static_cast<double>(count) / area, 1.5 * density);
    EXPECT_LE(made.stats.below_20_degrees, count / 1000 + 3);
    EXPECT_GT(quality(made.mesh).min_angle_deg.p01, 30);
  }
}

// The middle of a triangle with its corners on a ball lies below it, and its plane at least as far
// below at the deepest. Meshes are no finer than they need to be.
TEST(SurfaceRemesher, WithinADistanceOfABall) {
  const double radius = 2;
  const Vec3d center{1, 2, 3};
  const SphereSet ball({{center, radius}});
  for (const double distance : {0.5, 0.1, 0.02}) {
    SCOPED_TRACE(distance);
    const RemeshedSurface made = remesh_within(ball, distance);
    expect_sound(made, ball, 1.4, false);
    double deepest = 0, plane = 0;
    for (const Triangle& t : made.mesh.triangles) {
      const Vec3d a = made.mesh.positions[t[0]] - center, b = made.mesh.positions[t[1]] - center,
                  c = made.mesh.positions[t[2]] - center;
      deepest = std::max(deepest, radius - norm((1.0 / 3) * (a + b + c)));
      plane = std::max(plane, radius - std::abs(dot(a, unit(cross(b - a, c - a)))));
    }
    EXPECT_LE(deepest, distance);
    EXPECT_GE(plane, 0.5 * distance);
    EXPECT_LE(made.stats.farthest, distance);
    EXPECT_GE(made.stats.farthest, deepest);
  }
}

TEST(SurfaceRemesher, WithinADistanceOfThreeBalls) {
  const SphereSet triple({{{0, 0, 0}, 1.7}, {{4.2, 0, 0}, 1.5}, {{2, 3.6, 0.1}, 1.6}});
  std::size_t before = 0;
  for (const double distance : {0.4, 0.1, 0.02}) {
    SCOPED_TRACE(distance);
    const RemeshedSurface made = remesh_within(triple, distance, {.edge_length = 2});
    expect_sound(made, triple, 1.4, false);
    const HausdorffBounds bounds = excluded_distance_bounds(made.mesh, triple, 1.4);
    EXPECT_LE(bounds.upper(), distance);
    EXPECT_GE(bounds.upper(), 0.5 * distance);
    EXPECT_LE(made.stats.farthest, distance);
    EXPECT_GE(made.stats.farthest, bounds.lower());
    EXPECT_GT(made.mesh.triangle_count(), before);
    before = made.mesh.triangle_count();
  }
  // A mesh of 10⁹ triangles would be needed.
  EXPECT_THROW(remesh_within(triple, 1e-9, {.memory_limit = 20'000'000}), LimitExceeded);
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(remesh_within(triple, wrong), InvalidInput);
  }
}

TEST(SurfaceRemesher, TheSameBytesEachTime) {
  const SphereSet triple({{{0, 0, 0}, 1.7}, {{4.2, 0, 0}, 1.5}, {{2, 3.6, 0.1}, 1.6}});
  const RemeshOptions options{.probe = 1.4, .edge_length = 0.8};
  EXPECT_EQ(hash(remesh_excluded(triple, options).mesh),
            hash(remesh_excluded(triple, options).mesh));
}

TEST(SurfaceRemesher, RefusesWrongOptions) {
  const SphereSet ball({{{0, 0, 0}, 1.7}});
  for (const double length : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(remesh_excluded(ball, {.edge_length = length}), InvalidInput);
  }
  EXPECT_THROW(remesh_excluded(ball, {.probe = 0}), InvalidInput);
  EXPECT_THROW(remesh_excluded(SphereSet()), InvalidInput);
}

TEST(SurfaceRemesher, IsNotRefinedAlongCurvesThatItLacks) {
  const SphereSet ball({{{0, 0, 0}, 1.7}});
  EXPECT_THROW(refine_patches(ball, remesh_excluded(ball), {.subdivisions = 1}), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
