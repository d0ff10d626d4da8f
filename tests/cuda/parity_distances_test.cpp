// Distances of both backends: the same samples, the same figures, bit by bit.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/backend.hpp"
#include "cuda/parity.hpp"
#include "cuda/refused_memory.hpp"
#include "support/ball_families.hpp"
#include "support/shared_files.hpp"
#include "support/test_meshes.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

std::string figures(const MeshDistances& d) {
  char text[200];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g | %.17g %.17g %.17g", d.mesh_to_surface.mean,
                d.mesh_to_surface.rms, d.mesh_to_surface.max, d.surface_to_mesh.mean,
                d.surface_to_mesh.rms, d.surface_to_mesh.max);
  return text;
}

void expect_same_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                           const std::string& what, const DistanceOptions& options = {}) {
  const MeshDistances cpu =
      make_distance_measurer(Backend::cpu)->measure(mesh, spheres, options).result;
  const MeshDistances cuda =
      make_distance_measurer(Backend::cuda)->measure(mesh, spheres, options).result;
  EXPECT_EQ(std::memcmp(&cpu, &cuda, sizeof cpu), 0)
      << what << ": " << cpu.samples << " and " << cuda.samples << " samples\n"
      << figures(cpu) << "\n"
      << figures(cuda);
  const MeshDistances again =
      make_distance_measurer(Backend::cuda)->measure(mesh, spheres, options).result;
  EXPECT_EQ(std::memcmp(&cuda, &again, sizeof cuda), 0) << what << ", second run";
}

void expect_same_points(const std::vector<Vec3d>& points, const SphereSet& spheres,
                        const std::string& what) {
  const std::vector<double> cpu =
      make_distance_measurer(Backend::cpu)->measure_points(points, spheres).result;
  const std::vector<double> cuda =
      make_distance_measurer(Backend::cuda)->measure_points(points, spheres).result;
  ASSERT_EQ(cpu.size(), cuda.size());
  for (std::size_t i = 0; i < cpu.size(); ++i)
    ASSERT_EQ(cpu[i], cuda[i]) << what << ", point " << i;
}

// A sphere of a few triangles about each ball, larger or smaller than it.
IndexedMesh shells_about(const std::vector<Sphere>& balls, Dice& dice) {
  IndexedMesh mesh;
  for (const Sphere& ball : balls) {
    const double radius = ball.radius * dice.real(0.9, 1.2);
    const IndexedMesh shell = scaled(icosphere(dice.whole(0, 2)), radius);
    mesh = together(mesh, translated(dice.one_in(3) ? reversed(shell) : shell, ball.center));
  }
  return mesh;
}

std::vector<Vec3d> points_about(const std::vector<Sphere>& balls, Dice& dice) {
  std::vector<Vec3d> points;
  for (const Sphere& ball : balls)
    for (int i = 0; i < 20; ++i)
      points.push_back(ball.center + random_point(dice, dice.real(0, 3) * ball.radius));
  return points;
}

TEST_F(Parity, DistancesOfFamiliesOfBalls) {
  for (const BallFamily& family : kBallFamilies) {
    for (unsigned seed = 1; seed <= 6; ++seed) {
      Dice dice(seed);
      const std::vector<Sphere> balls = family.make(dice);
      const std::string what = std::string(family.name) + " " + std::to_string(seed);
      expect_same_distances(shells_about(balls, dice), SphereSet(balls), what, {.seed = seed});
      expect_same_points(points_about(balls, dice), SphereSet(balls), what);
    }
  }
}

// A void, and balls that are equal or nested; needles, flat triangles and triangles without area;
// one triangle; numbers of triangles around those of a block and of a node.
TEST_F(Parity, DistancesOfOddMeshes) {
  const SphereSet crowded = crowd(200, 6, 0.3, 1.6, 3);
  expect_same_distances(make_mesh({{0, 0, 0}, {3, 0, 0}, {0, 4, 1}}, {{0, 1, 2}}), crowded, "one");
  for (const KnownMesh& known : known_meshes()) {
    if (known.mesh.triangle_count() == 0) continue;
    expect_same_distances(known.mesh, crowded, known.name);
  }
  Dice dice(5);
  for (const int count : {7, 8, 9, 63, 64, 65, 2047, 2048, 2049, 5000}) {
    IndexedMesh soup;
    for (int t = 0; t < count; ++t) {
      const Vec3d at = random_point(dice, 8);
      const double size = std::pow(10, dice.real(-9, 0.5));
      const auto first = static_cast<std::uint32_t>(soup.vertex_count());
      for (int k = 0; k < 3; ++k) soup.positions.push_back(at + random_point(dice, size));
      if (dice.one_in(5)) soup.positions.back() = soup.positions[first];  // no area
      soup.triangles.push_back({first, first + 1, first + 2});
    }
    soup.positions.push_back({50, 0, 0});  // on no triangle
    expect_same_distances(soup, crowded, std::to_string(count) + " triangles");
  }
  const std::vector<Sphere> twice{{{0, 0, 0}, 2}, {{0, 0, 0}, 2}, {{0.1, 0, 0}, 1.5}};
  expect_same_distances(latitudes(24, 150), SphereSet(twice), "equal and nested balls");
  expect_same_distances(translated(icosphere(4), {1e6, 3, 2}), crowded, "far off");
}

// Few samples, so that a warp has them of all three balls: the mesh is close to the second ball;
// the first has more triangles near each of its points than a device lists; and none is near the
// third.
TEST_F(Parity, DistancesNearFewAndManyTriangles) {
  const SphereSet balls({{{0, 0, 0}, 1}, {{6, 0, 0}, 1}, {{0, 14, 0}, 1}});
  IndexedMesh mesh = translated(scaled(icosphere(1), 1.2), {6, 0, 0});
  for (int shell = 1; shell <= 6; ++shell) mesh = together(mesh, scaled(icosphere(4), 0.2 * shell));
  for (const double density : {0.5, 1.0, 10.0})
    expect_same_distances(mesh, balls, "density " + std::to_string(density),
                          {.samples_per_area = density});
}

IndexedMesh mesh_of(const SphereSet& spheres, double spacing, int subdivisions) {
  RefineOptions refine;
  refine.subdivisions = subdivisions;
  return make_pipeline(Backend::cpu)
      ->run(spheres, options_of(FieldKind::vdw, spacing), refine)
      .mesh;
}

TEST_F(Parity, DistancesOfMolecules) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  const SphereSet crambin = read_xyzr(shared_path("reference/1CRN.xyzr"));
  expect_same_distances(mesh_of(crambin, 0.5, 0), crambin, "crambin");
  const IndexedMesh refined = mesh_of(crambin, 0.5, 1);
  expect_same_distances(refined, crambin, "crambin, refined", {.samples_per_area = 137, .seed = 9});
  const std::vector<Vec3d> vertices(refined.positions.begin(), refined.positions.end());
  expect_same_points(vertices, crambin, "crambin, vertices");
}

// More samples than one launch measures, both ways.
TEST_F(Parity, DistancesInSeveralLaunches) {
  Dice dice(7);
  const std::vector<Sphere> balls = chain(dice);
  double area = 0;
  for (const Sphere& ball : balls) area += 12.6 * ball.radius * ball.radius;
  expect_same_distances(shells_about(balls, dice), SphereSet(balls), "a chain",
                        {.samples_per_area = 3e7 / area});
}

TEST_F(Parity, DistancesThatDoNotFit) {
  const SphereSet spheres = crowd(100, 5, 0.8, 1.6, 4);
  const IndexedMesh mesh = icosphere(4);
  const auto cpu = make_distance_measurer(Backend::cpu);
  const auto automatic = make_distance_measurer(Backend::automatic);
  const MeshDistances expected = cpu->measure(mesh, spheres).result;
  EXPECT_EQ(automatic->measure(mesh, spheres).fallback, "");
  EXPECT_EQ(automatic->measure_points(mesh.positions, spheres).fallback, "");
  const RefusedMemory refused;
  EXPECT_THROW(make_distance_measurer(Backend::cuda)->measure(mesh, spheres), DeviceMemoryExceeded);
  const MeasuredDistances measured = automatic->measure(mesh, spheres);
  EXPECT_EQ(std::memcmp(&measured.result, &expected, sizeof expected), 0);
  EXPECT_NE(measured.fallback.find("on the CPU: "), std::string::npos) << measured.fallback;
  const MeasuredPoints points = automatic->measure_points(mesh.positions, spheres);
  EXPECT_EQ(points.result, cpu->measure_points(mesh.positions, spheres).result);
  EXPECT_NE(points.fallback.find("on the CPU: "), std::string::npos) << points.fallback;
}

}  // namespace
}  // namespace vdwmesh::testing
