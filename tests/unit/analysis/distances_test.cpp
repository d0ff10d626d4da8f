// Distances of meshes and unions of balls: closed forms and awkward input.
#include "analysis/distances.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "core/errors.hpp"
#include "support/shared_files.hpp"
#include "support/test_meshes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh {
namespace {

using ::testing::HasSubstr;
using testing::icosphere;
using testing::make_mesh;
using testing::scaled;
using testing::translated;

// Å. Some 100 roundings of lengths of a few Å; the square of a length is what is compared.
constexpr double kRounding = 1e-12;
// vertex_distances are floats: half a unit in the last place below 4 Å.
constexpr double kFloatRounding = 1.2e-7;

SphereSet unit_ball() { return SphereSet({{{0, 0, 0}, 1}}); }

// Distance of one point, through the vertices of a mesh without triangles.
double distance_of(const Vec3d& p, const SphereSet& spheres) {
  const std::vector<float> d = vertex_distances(make_mesh({p}, {}), spheres);
  return static_cast<double>(d.at(0));
}

// Mean and mean square of 1 - |x| over the triangles, from the midpoints of 4^levels parts of each:
// off by the square of their size.
std::pair<double, double> depths_below_unit_sphere(const IndexedMesh& mesh, int levels) {
  IndexedMesh fine = mesh;
  for (int level = 0; level < levels; ++level) fine = testing::quartered(fine);
  double area = 0, first = 0, second = 0;
  for (const auto& [i, j, k] : fine.triangles) {
    const Vec3d &a = fine.positions[i], &b = fine.positions[j], &c = fine.positions[k];
    const double part = norm(cross(b - a, c - a)) / 2, depth = 1 - norm((1.0 / 3) * (a + b + c));
    area += part, first += part * depth, second += part * depth * depth;
  }
  return {first / area, second / area};
}

// How many standard errors a figure may be off: once in 10^6 figures, of a fixed seed.
constexpr double kSigmas = 5;

TEST(Distances, InscribedIcosahedronIsOffByWhatItsFacesAre) {
  const IndexedMesh mesh = icosphere(0);
  const auto [mean, square] = depths_below_unit_sphere(mesh, 6);
  constexpr double kMidpointRule = 1e-4;  // Å, at parts of edge 1/64
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const DistanceStatistics d = distances(mesh, unit_ball(), {.seed = seed}).mesh_to_surface;
    EXPECT_NEAR(d.mean, mean, kSigmas * d.mean_error + kMidpointRule);
    EXPECT_NEAR(d.rms, std::sqrt(square), kSigmas * d.rms_error + kMidpointRule);
    // That of 10^4 independent points.
    EXPECT_NEAR(d.mean_error, std::sqrt((square - mean * mean) / 1e4), 0.02 * d.mean_error);
  }
  // Inradius of the icosahedron of circumradius 1.
  const double phi = std::numbers::phi;
  const double inradius = phi * phi / (std::sqrt(3.0) * std::sqrt(phi * phi + 1));
  const MeshDistances d = distances(mesh, unit_ball(), {.samples_per_area = 1e-3});
  EXPECT_NEAR(d.mesh_to_surface.max, 1 - inradius, kRounding);
  EXPECT_EQ(d.mesh_to_surface.samples, 10000 + 20 + 12);
  // The nearest point of the mesh is at most a face centre's depth away, and some sample of 10^4
  // is within 0.02 of a face centre's direction.
  EXPECT_LE(d.surface_to_mesh.max, 1 - inradius + kRounding);
  EXPECT_GE(d.surface_to_mesh.max, (1 - inradius) - 0.02 * 0.02);
  EXPECT_EQ(d.hausdorff_lower_bound, std::max(d.mesh_to_surface.max, d.surface_to_mesh.max));
  EXPECT_EQ(d.samples, d.mesh_to_surface.samples + d.surface_to_mesh.samples);
}

// The inscribed sphere by circles of latitude: at the poles triangles a thousand times smaller than
// at the equator. A denser sampling must not move the figures by more than their errors.
TEST(Distances, DensityChangesTheErrorAndNotTheValue) {
  for (const IndexedMesh& mesh : {testing::latitudes(24, 150), scaled(icosphere(4), 1)}) {
    const DistanceStatistics a = distances(mesh, unit_ball()).mesh_to_surface;
    const DistanceStatistics b =
        distances(mesh, unit_ball(), {.samples_per_area = 20'000, .seed = 9}).mesh_to_surface;
    EXPECT_NEAR(a.mean, b.mean, kSigmas * std::hypot(a.mean_error, b.mean_error));
    EXPECT_NEAR(a.rms, b.rms, kSigmas * std::hypot(a.rms_error, b.rms_error));
    EXPECT_LT(b.mean_error, 0.3 * a.mean_error);
    EXPECT_LT(a.mean_error, 0.01 * a.mean);
  }
}

// A flat disc of radius R at height h over the unit ball's centre, cut into `rings` rings.
IndexedMesh disc_above(double height, double radius, int rings, const Vec3d& centre) {
  constexpr int kSpokes = 360;
  IndexedMesh mesh;
  for (int ring = 0; ring <= rings; ++ring)
    for (int k = 0; k < kSpokes; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSpokes, r = radius * ring / rings;
      mesh.positions.push_back(centre + Vec3d{r * std::cos(angle), r * std::sin(angle), height});
    }
  const auto at = [](int ring, int k) {
    return static_cast<std::uint32_t>(kSpokes * ring + k % kSpokes);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int k = 0; k < kSpokes; ++k) {
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k), at(ring + 1, k + 1)});
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring, k + 1)});
    }
  return mesh;
}

// Two discs, of areas 3 : 7: the first of a hundred times as many triangles, and nearer everywhere.
// The inner ring's are half of area 0.
TEST(Distances, PercentilesCountAreaAndNotTriangles) {
  const double near = 1.5, far = 5, r = std::sqrt(3.0), s = std::sqrt(7.0);
  const SphereSet balls({{{0, 0, 0}, 1}, {{100, 0, 0}, 1}});
  const IndexedMesh mesh =
      testing::together(disc_above(near, r, 100, {0, 0, 0}), disc_above(far, s, 1, {100, 0, 0}));
  const DistanceStatistics d = distances(mesh, balls).mesh_to_surface;
  // Of which the fraction p of the area is nearer: 1 to the sphere, h and ρ to its centre.
  const auto quantile = [&](double p) {
    const bool first = p <= 0.3;
    const double rho = first ? r * std::sqrt(p / 0.3) : s * std::sqrt((p - 0.3) / 0.7);
    return std::hypot(first ? near : far, rho) - 1;
  };
  const auto expect_quantile = [&](double found, double p) {
    // The fraction below a quantile is binomial; polygons of 360 sides miss 5e-5 of the area.
    const double off = kSigmas * std::sqrt(p * (1 - p) / 1e4) + 5e-5, bin = 1.0 / 512;
    EXPECT_GE(found, quantile(p - off) * (1 - bin)) << p;
    EXPECT_LE(found, quantile(std::min(1.0, p + off)) * (1 + bin)) << p;
  };
  expect_quantile(d.p50, 0.50);
  expect_quantile(d.p95, 0.95);
  expect_quantile(d.p99, 0.99);
  // ∫ (√(ρ² + h²) - 1) 2ρ dρ / R² over each.
  const auto mean_of = [](double h, double radius) {
    const double square = radius * radius;
    return 2 / (3 * square) * (std::pow(square + h * h, 1.5) - h * h * h) - 1;
  };
  EXPECT_NEAR(d.mean, 0.3 * mean_of(near, r) + 0.7 * mean_of(far, s),
              kSigmas * d.mean_error + 5e-5 * d.mean);
}

// Order 2, as for every inscribed mesh.
TEST(Distances, BothDirectionsFallWithTheSquareOfTheEdge) {
  const MeshDistances coarse = distances(icosphere(3), unit_ball());
  const MeshDistances fine = distances(icosphere(4), unit_ball());
  for (const auto part : {&MeshDistances::mesh_to_surface, &MeshDistances::surface_to_mesh}) {
    const DistanceStatistics &a = coarse.*part, &b = fine.*part;
    // The ratio is 4 in the limit; at edges of 0.14 and 0.07 the next order is below 2 %.
    EXPECT_NEAR(a.mean / b.mean, 4, 0.08);
    EXPECT_NEAR(a.rms / b.rms, 4, 0.08);
  }
}

TEST(Distances, ScaledMeshIsOffByTheScale) {
  // Vertices at 1.25: so fine that faces are 1.25·(1 - 0.0006) away at least.
  const IndexedMesh mesh = scaled(icosphere(5), 1.25);
  const double sagitta = 1.25 * 6e-4;
  const MeshDistances d = distances(mesh, unit_ball());
  EXPECT_NEAR(d.mesh_to_surface.max, 0.25, kRounding);  // at the vertices
  for (const DistanceStatistics& s : {d.mesh_to_surface, d.surface_to_mesh}) {
    for (const double value : {s.mean, s.rms, s.p50, s.p95, s.p99, s.max}) {
      // Percentiles are known to 1/512 octave.
      EXPECT_LE(value, 0.25 * (1 + 0.0014) + kRounding);
      EXPECT_GE(value, (0.25 - sagitta) * (1 - 0.0014));
    }
  }
}

TEST(Distances, FarMeshesAreFar) {
  const MeshDistances d = distances(translated(icosphere(2), {1000, 0, 0}), unit_ball());
  EXPECT_GT(d.mesh_to_surface.mean, 998);
  EXPECT_GT(d.surface_to_mesh.mean, 997.9);
  EXPECT_LE(d.mesh_to_surface.max, 1000 + kRounding * 1000);
}

// Balls of radius 1 at ±0.5: spheres meet in the circle of radius √(3)/2 in the plane x = 0.
TEST(VertexDistances, NearestPointOfABuriedCapIsOnTheCircle) {
  const SphereSet balls({{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}});
  const double circle = std::sqrt(0.75);
  // Radially outward from either centre these points run into the other ball.
  for (const Vec3d& p :
       {Vec3d{0, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0.1, 0, 0.3}, Vec3d{0, -0.2, 0.6}}) {
    const double radial = std::hypot(p.y, p.z);
    EXPECT_NEAR(distance_of(p, balls), -std::hypot(p.x, circle - radial), kFloatRounding);
  }
  // On the sphere of one ball, inside the other: 0.5 from a sphere, yet the circle is at √(3)/2.
  EXPECT_NEAR(distance_of({0, 0, 0}, balls), -circle, kFloatRounding);
  EXPECT_NEAR(distance_of({0.5, 0, 0}, balls), -1, kFloatRounding);  // a centre
  EXPECT_NEAR(distance_of({1, 0, 0}, balls), -0.5, kFloatRounding);
  EXPECT_NEAR(distance_of({2, 0, 0}, balls), 0.5, kFloatRounding);
  // Outside, in the notch: the two spheres are as near.
  EXPECT_NEAR(distance_of({0, 2, 0}, balls), std::sqrt(4.25) - 1, kFloatRounding);
}

// Three unit balls on a circle of radius 0.6: corners on the axis at height 0.8.
TEST(VertexDistances, NearestPointMayBeACorner) {
  std::vector<Sphere> balls;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * std::numbers::pi * k / 3;
    balls.push_back({{0.6 * std::cos(angle), 0.6 * std::sin(angle), 0}, 1});
  }
  const SphereSet union_of_three(balls);
  for (const double z : {0.0, 0.1, 0.5, 0.79})
    EXPECT_NEAR(distance_of({0, 0, z}, union_of_three), z - 0.8, kFloatRounding);
  EXPECT_NEAR(distance_of({0, 0, -0.7}, union_of_three), -0.1, kFloatRounding);
  EXPECT_NEAR(distance_of({0, 0, 1.2}, union_of_three), std::hypot(0.6, 1.2) - 1, kFloatRounding);
}

// Nested balls and a duplicate: one sphere is all there is.
TEST(VertexDistances, BuriedBallsHaveNoSurface) {
  const SphereSet balls({{{0, 0, 0}, 2}, {{0.3, 0, 0}, 1}, {{0, 0.5, 0}, 1.5}, {{0, 0, 0}, 2}});
  EXPECT_NEAR(distance_of({0.3, 0, 0}, balls), -1.7, kFloatRounding);
  EXPECT_NEAR(distance_of({0, 0, 1}, balls), -1, kFloatRounding);
  EXPECT_NEAR(distance_of({0, 0, 0}, balls), -2, kFloatRounding);
}

TEST(VertexDistances, LatticeWithManyBallsThroughOnePoint) {
  // Unit cubes of centres, radius √(3)/2: eight spheres meet in the middle of each cell.
  std::vector<Sphere> balls;
  const double r = std::sqrt(0.75);
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z) balls.push_back({{double(x), double(y), double(z)}, r});
  const SphereSet lattice(balls);
  // Below a face of the lattice four spheres meet 0.5 from the plane of the centres. Above it are
  // the middles of cells, as far away: points that eight closed balls share and none covers.
  EXPECT_NEAR(distance_of({0.5, 0.5, 0}, lattice), -0.5, kFloatRounding);
}

TEST(Distances, WrongMoleculeCannotBeMissed) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  VDWMESH_NEEDS_SHARED("reference/1UBQ.xyzr");
  const SphereSet crambin = testing::read_xyzr(testing::shared_path("reference/1CRN.xyzr"));
  const SphereSet ubiquitin = testing::read_xyzr(testing::shared_path("reference/1UBQ.xyzr"));
  IndexedMesh mesh;
  for (const Sphere& s : crambin.spheres())
    mesh = testing::together(mesh, translated(scaled(icosphere(1), s.radius), s.center));
  EXPECT_GT(distances(mesh, ubiquitin).surface_to_mesh.rms, 5);
  EXPECT_LT(distances(mesh, crambin).surface_to_mesh.rms, 0.3);
}

bool same_bits(const MeshDistances& a, const MeshDistances& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

SphereSet cluster(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(0, 5), radius(0.8, 1.7);
  std::vector<Sphere> balls;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), z = place(random);
    balls.push_back({{x, y, z}, radius(random)});
  }
  return SphereSet(balls);
}

TEST(Distances, SameForAnyNumberOfThreads) {
  const SphereSet balls = cluster(200, 3);
  const IndexedMesh mesh = translated(scaled(icosphere(4), 3), {2.5, 2.5, 2.5});
  std::vector<MeshDistances> results;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(distances(mesh, balls));
  }
  EXPECT_TRUE(same_bits(results[0], results[1]));
  EXPECT_TRUE(same_bits(results[0], results[2]));
}

TEST(Distances, OrderOfTheSpheresDoesNotMatter) {
  const SphereSet balls = cluster(60, 4);
  std::vector<Sphere> reversed(balls.spheres().rbegin(), balls.spheres().rend());
  const IndexedMesh mesh = translated(scaled(icosphere(3), 3), {2.5, 2.5, 2.5});
  EXPECT_TRUE(same_bits(distances(mesh, balls), distances(mesh, SphereSet(reversed))));
}

TEST(Distances, SeedMovesTheSamples) {
  const SphereSet balls = cluster(60, 4);
  const IndexedMesh mesh = translated(scaled(icosphere(3), 3), {2.5, 2.5, 2.5});
  const MeshDistances a = distances(mesh, balls, {.seed = 1});
  const MeshDistances b = distances(mesh, balls, {.seed = 2});
  EXPECT_EQ(a.seed, 1u);
  EXPECT_NE(a.surface_to_mesh.mean, b.surface_to_mesh.mean);
  EXPECT_NE(a.mesh_to_surface.mean, b.mesh_to_surface.mean);
  EXPECT_NEAR(a.mesh_to_surface.mean, b.mesh_to_surface.mean,
              kSigmas * std::hypot(a.mesh_to_surface.mean_error, b.mesh_to_surface.mean_error));
  // 10^4 samples on all spheres: the lattices integrate a smooth function better than random
  // points, whose error would be 1 %.
  EXPECT_NEAR(a.surface_to_mesh.mean / b.surface_to_mesh.mean, 1, 0.02);
}

// Degenerate triangles have no weight and are still part of the mesh.
TEST(Distances, DegenerateTrianglesCount) {
  IndexedMesh mesh = icosphere(3);
  const auto next = static_cast<std::uint32_t>(mesh.vertex_count());
  mesh.positions.push_back({1, 0, 0});
  mesh.positions.push_back({3, 0, 0});
  mesh.triangles.push_back({next, next + 1, next + 1});
  const MeshDistances d = distances(mesh, unit_ball());
  EXPECT_NEAR(d.mesh_to_surface.max, 2, kRounding);
  EXPECT_LT(d.mesh_to_surface.rms, 0.01);
}

TEST(Distances, IsolatedVerticesAreNoPartOfTheMesh) {
  IndexedMesh mesh = icosphere(3);
  mesh.positions.push_back({7, 0, 0});
  EXPECT_LT(distances(mesh, unit_ball()).mesh_to_surface.max, 0.01);
}

template <class Call>
void expect_invalid(const Call& call, const std::string& reason) {
  try {
    call();
    ADD_FAILURE() << "accepted; expected: " << reason;
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr(reason));
  }
}

TEST(Distances, RefusesWhatHasNoDistances) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const IndexedMesh good = icosphere(0);
  expect_invalid([] { distances({}, unit_ball()); }, "no triangles");
  expect_invalid([&] { distances(good, SphereSet()); }, "no spheres");
  expect_invalid([&] { vertex_distances(good, SphereSet()); }, "no spheres");
  IndexedMesh broken = good;
  broken.positions[7].y = nan;
  expect_invalid([&] { distances(broken, unit_ball()); }, "vertex 7");
  expect_invalid([&] { vertex_distances(broken, unit_ball()); }, "vertex 7");
  IndexedMesh stray = good;
  stray.triangles[3][1] = 12;
  expect_invalid([&] { distances(stray, unit_ball()); }, "triangle 3 names vertex 12");
  expect_invalid([&] { distances(scaled(good, 0), unit_ball()); }, "no area");
  for (const double samples : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()})
    expect_invalid([&] { distances(good, unit_ball(), {.samples_per_area = samples}); }, "samples");
}

TEST(Distances, RefusesAnAreaThatIsNothing) {
  const SphereSet dust({{{0, 0, 0}, 1e-170}});  // whose 4πr² is 0
  EXPECT_THROW(distances(icosphere(1), dust), InvalidInput);
}

TEST(Distances, RefusesBeforeItTakesTooMuch) {
  const IndexedMesh mesh = icosphere(4);
  try {
    distances(mesh, unit_ball(), {.memory_limit = 100000});
    ADD_FAILURE() << "accepted";
  } catch (const LimitExceeded& error) {
    EXPECT_THAT(error.what(), HasSubstr("100000 are allowed"));
    EXPECT_THAT(error.what(), HasSubstr("subdivision"));
    // Triangles, and with them bytes, fall by the square of the spacing.
    const std::string text = error.what();
    const auto number_after = [&](const std::string& words) {
      return std::stod(text.substr(text.find(words) + words.size()));
    };
    const double need = number_after("triangles need "), wider = number_after("a spacing ");
    EXPECT_GE(wider * wider, need / 100000);
    EXPECT_LE(wider * wider, 1.1 * need / 100000);
  }
  EXPECT_THROW(distances(mesh, unit_ball(), {.samples_per_area = 1e15}), LimitExceeded);
  // Half as much again as the mesh is enough.
  const std::uint64_t mesh_bytes = indexed_mesh_bytes({mesh.vertex_count(), mesh.triangle_count()});
  EXPECT_NO_THROW(distances(mesh, unit_ball(), {.memory_limit = mesh_bytes + mesh_bytes / 2}));
}

}  // namespace
}  // namespace vdwmesh
