#include "contract/exact_mesher_contract.hpp"

#include <array>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "support/crease_tolerance.hpp"

namespace vdwmesh::testing {
namespace {

// The mesher of the running test; null without a backend.
std::unique_ptr<ExactMesher> current_mesher;

// The surface that the mesh stands for is that of the union, to rounding; where features were made
// points, a strip as wide as a vertex may be off, along arcs of ten radii, is forgiven.
void expect_measures(const SphereSet& spheres, const IndexedMesh& mesh,
                     const reference::MeshFacts& facts, const ExactUnion& exact,
                     const Demands& demands) {
  constexpr double kRounding = 1e-9, kStrip = 10;
  const MeasureDifference difference = measure_difference(spheres, mesh, facts, exact);
  const double tolerance = kRounding + kStrip * demands.distance;
  EXPECT_LE(difference.area, tolerance);
  EXPECT_LE(difference.volume, tolerance);
}

void expect_topology(const SphereSet& spheres, const reference::MeshFacts& facts,
                     const UnionTopology& exact, const Demands& demands) {
  const TopologyDifference found = topology_difference(spheres, facts, exact);
  EXPECT_EQ(found.euler_characteristic, demands.euler_difference);
  EXPECT_EQ(found.components + found.voids, demands.shell_difference);
  if (demands.topology == Topology::exact) {
    EXPECT_EQ(found.components, 0);
    EXPECT_EQ(found.voids, 0);
  }
}

// With vertices in one place made one, so that shells which only touch there do not count as
// crossing: a point of contact is doubled.
IndexedMesh welded(const IndexedMesh& mesh) {
  IndexedMesh result = mesh;
  std::map<std::array<double, 3>, std::uint32_t> first;
  std::vector<std::uint32_t> name;
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d& p = mesh.positions[v];
    name.push_back(first.insert({{p.x, p.y, p.z}, v}).first->second);
  }
  for (Triangle& t : result.triangles) {
    for (std::uint32_t& v : t) v = name[v];
  }
  return result;
}

// A vertex on several spheres has the mean of their normals, unless they cancel.
void expect_mean_normals(const SphereSet& spheres, const IndexedMesh& mesh) {
  std::size_t wrong = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    Vec3d sum{};
    for (const SphereId id : mesh.vertex_spheres[v]) {
      if (id == kNoSphere) continue;
      const Vec3d out = mesh.positions[v] - spheres.spheres()[id].center;
      sum = sum + (1 / norm(out)) * out;
    }
    if (norm(sum) < 1e-3) continue;
    wrong += !(norm(cast<double>(mesh.normals[v]) - (1 / norm(sum)) * sum) < 1e-5);
  }
  EXPECT_EQ(wrong, 0u);
}

}  // namespace

void ExactMesherContract::SetUp() {
  need(GetParam());
  if (!IsSkipped()) current_mesher = make_exact_mesher(GetParam());
}
void ExactMesherContract::TearDown() { current_mesher.reset(); }

ExactMesh mesh_with(const SphereSet& spheres, ExactMeshOptions options) {
  if (!current_mesher) return mesh_union(spheres, options);
  options.device_work = DeviceWork::all;
  ExactMesh made = current_mesher->mesh(spheres, options);
  // Devices leave meshes with a bound on their angles to the host.
  if (options.min_angle == 0) {
    EXPECT_EQ(made.fallback, "");
  }
  return made;
}

ExactMesh mesh_at(const SphereSet& spheres, double edge_length) {
  ExactMeshOptions options;
  options.edge_length = edge_length;
  return mesh_with(spheres, options);
}

IndexedMesh subdivided(const SphereSet& spheres, const IndexedMesh& mesh, int levels,
                       const Demands& demands) {
  RefineOptions options;
  options.subdivisions = levels;
  RefineResult result = make_cpu_refiner()->refine(spheres, mesh, options);
  for (const ProjectionStats& s : result.levels) {
    EXPECT_EQ(s.turned, 0u);
    if (demands.distance <= kProjectionTolerance) {
      EXPECT_EQ(s.unconverged, 0u);
    }
  }
  return std::move(result.mesh);
}

void expect_union_mesh(const SphereSet& spheres, const IndexedMesh& mesh, const ExactUnion& exact,
                       const Demands& demands) {
  ASSERT_EQ(mesh.normals.size(), mesh.vertex_count());
  ASSERT_EQ(mesh.vertex_spheres.size(), mesh.vertex_count());
  ASSERT_EQ(mesh.triangle_spheres.size(), mesh.triangle_count());
  const CreaseSurvey survey = survey_creases(spheres, mesh);
  EXPECT_TRUE(survey.sound()) << survey.text();
  EXPECT_LE(survey.off_sphere, demands.distance);
  EXPECT_LE(survey.depth, demands.distance);
  if (demands.topology == Topology::exact) {
    EXPECT_EQ(survey.strange_labels, 0u) << survey.text();
  }
  expect_topology(spheres, survey.facts, exact.topology.value(), demands);
  expect_measures(spheres, mesh, survey.facts, exact, demands);
  if (mesh.triangle_count() <= demands.largest_searched) {
    const bool touches = demands.topology == Topology::parted || exact.topology->point_contacts > 0;
    EXPECT_EQ(self_intersections(touches ? welded(mesh) : mesh), 0u) << survey.text();
  }
}

IndexedMesh expect_union_meshes(const SphereSet& spheres, double edge_length, int levels,
                                const Demands& asked) {
  const ExactUnion exact = exact_union(spheres);
  ExactMesh made = mesh_at(spheres, edge_length);
  Demands demands = asked;
  if (asked.topology == Topology::parted) {
    demands.euler_difference = made.stats.euler_difference;
    demands.shell_difference = made.stats.shell_difference;
  }
  IndexedMesh mesh = std::move(made.mesh);
  expect_union_mesh(spheres, mesh, exact, demands);
  expect_mean_normals(spheres, mesh);
  for (int level = 1; level <= levels; ++level) {
    SCOPED_TRACE("level " + std::to_string(level));
    expect_union_mesh(spheres, subdivided(spheres, mesh, level, demands), exact, demands);
  }
  return mesh;
}

SphereSet cage(const std::vector<Vec3d>& directions, double cage_radius, double ball_radius) {
  std::vector<Sphere> spheres;
  for (const Vec3d& d : directions) spheres.push_back({(cage_radius / norm(d)) * d, ball_radius});
  return SphereSet(std::move(spheres));
}

std::vector<Vec3d> octahedron_corners() {
  return {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
}

std::vector<Vec3d> icosahedron_corners() {
  std::vector<Vec3d> corners;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-std::numbers::phi, std::numbers::phi}) {
      corners.push_back({0, s, t});
      corners.push_back({s, t, 0});
      corners.push_back({t, 0, s});
    }
  }
  return corners;
}

Demands demands_of_set(const SeededSet& set, const ExactMeshStats& stats) {
  Demands demands;
  demands.distance = allowed_distance(set.spheres, stats);
  if (sphere_recipes()[set.recipe].position == Position::nearly_degenerate) {
    demands.topology = Topology::parted;
    demands.euler_difference = stats.euler_difference;
    demands.shell_difference = stats.shell_difference;
  }
  demands.largest_searched = 0;
  return demands;
}

}  // namespace vdwmesh::testing
