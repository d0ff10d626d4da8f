#include "contract/extractor_contract.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "support/requirements.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;

// The angles of 3 F corners are each good to about 1e-15, but atan2 of sides of near 0 length
// (an edge parameter of 2^-20) loses up to six digits.
constexpr double kAngleTolerance = 1e-9;  // rad per vertex

reference::Function oracle_function(FieldKind kind) {
  switch (kind) {
    case FieldKind::blinn:
      return reference::Function::blinn;
    case FieldKind::soft_object:
      return reference::Function::soft_object;
    default:
      return reference::Function::inverse_squared;
  }
}

}  // namespace

std::string backend_name(Backend backend) { return backend == Backend::cuda ? "cuda" : "cpu"; }

std::string field_name(FieldKind kind) {
  switch (kind) {
    case FieldKind::vdw:
      return "vdw";
    case FieldKind::blinn:
      return "blinn";
    case FieldKind::soft_object:
      return "soft_object";
    case FieldKind::inverse_squared:
      return "inverse_squared";
  }
  return "unknown";
}

std::string backend_and_field_name(const std::tuple<Backend, FieldKind>& parameters) {
  return backend_name(std::get<0>(parameters)) + "_" + field_name(std::get<1>(parameters));
}

std::string missing_backend(Backend backend) {
  if (backend != Backend::cuda) return "";
  const DeviceList list = cuda_devices();
  if (!list.devices.empty()) return "";
  return list.reason.empty() ? "no CUDA device" : list.reason;
}

void BackendTest::need(Backend backend) {
  const std::string missing = missing_backend(backend);
  if (missing.empty()) return;
  VDWMESH_MISSING("VDWMESH_REQUIRE_CUDA", missing);
}

ExtractOptions ExtractorFieldContract::at_spacing(double spacing) const {
  ExtractOptions options;
  options.field.kind = kind();
  options.grid.spacing = spacing;
  return options;
}

std::vector<reference::Ball> to_balls(const SphereSet& spheres) {
  std::vector<reference::Ball> balls;
  for (const Sphere& s : spheres.spheres()) balls.push_back({to_point(s.center), s.radius});
  return balls;
}

reference::FieldOracle to_oracle(const FieldOptions& field, const GridSpec& grid) {
  reference::FieldOracle oracle;
  oracle.function = oracle_function(field.kind);
  oracle.preset = field.preset == FieldPreset::radius_aware ? reference::Preset::radius_aware
                  : field.preset == FieldPreset::thesis     ? reference::Preset::thesis
                                                            : reference::Preset::thesis_vdw;
  oracle.lattice = {to_point(grid.origin), grid.spacing};
  oracle.blobbiness = field.blobbiness.value_or(2);
  return oracle;
}

reference::MeshFacts facts_of(const ExtractResult& result) {
  return reference::inspect(to_reference(result.mesh));
}

// Where it is filled, `opposite` pairs every half-edge with the one that runs back.
void expect_opposites(const IndexedMesh& mesh, const std::string& what) {
  ASSERT_EQ(mesh.opposite.size(), 3 * mesh.triangle_count()) << what;
  const auto origin = [&](std::size_t e) { return mesh.triangles[e / 3][e % 3]; };
  const auto target = [&](std::size_t e) { return mesh.triangles[e / 3][(e + 1) % 3]; };
  for (std::size_t e = 0; e < mesh.opposite.size(); ++e) {
    const std::size_t back = mesh.opposite[e];
    ASSERT_LT(back, mesh.opposite.size()) << what;
    ASSERT_EQ(mesh.opposite[back], e) << what;
    ASSERT_EQ(origin(e), target(back)) << what;
    ASSERT_EQ(target(e), origin(back)) << what;
  }
}

void expect_sound(const ExtractResult& result, const std::string& what, Connectivity connectivity) {
  const IndexedMesh& mesh = result.mesh;
  ASSERT_EQ(mesh.normals.size(), mesh.vertex_count()) << what;
  ASSERT_EQ(mesh.vertex_spheres.size(), mesh.vertex_count()) << what;
  ASSERT_EQ(mesh.vertex_spheres.width(), LabelWidth::one) << what;
  if (connectivity == Connectivity::half_edges) {
    expect_opposites(mesh, what);
  } else {
    EXPECT_TRUE(mesh.opposite.empty()) << what;
  }
  const reference::MeshFacts facts = facts_of(result);
  EXPECT_TRUE(facts.closed_oriented_manifold()) << what << ": " << facts.summary();
  EXPECT_EQ(facts.degenerate_triangles, 0u) << what;
  EXPECT_GT(facts.volume, 0) << what;
  EXPECT_EQ(facts.euler_characteristic() % 2, 0) << what;
  EXPECT_NEAR(facts.angle_defect, 2 * kPi * static_cast<double>(facts.euler_characteristic()),
              kAngleTolerance * static_cast<double>(facts.vertices))
      << what;
}

SphereSet one_sphere(double radius) { return SphereSet({{{0, 0, 0}, radius}}); }

SphereSet two_spheres(double r1, double r2, double distance) {
  // Along (2, 3, 6) / 7, so that the crease is not aligned with the grid.
  const double s = distance / 7;
  return SphereSet({{{0, 0, 0}, r1}, {{2 * s, 3 * s, 6 * s}, r2}});
}

SphereSet ring_of_spheres(int count, double ring_radius, double radius) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double a = 2 * kPi * i / count;
    // In a plane tilted by about 20 degrees.
    const double u = ring_radius * std::cos(a), v = ring_radius * std::sin(a);
    spheres.push_back({{u, 0.94 * v, std::sqrt(1 - 0.94 * 0.94) * v}, radius});
  }
  return SphereSet(std::move(spheres));
}

SphereSet hollow_shell(int count, double shell_radius, double ball_radius) {
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1) / static_cast<double>(count);
    const double a = i * kPi * (3 - std::sqrt(5.0)), rho = std::sqrt(1 - z * z);
    spheres.push_back(
        {{shell_radius * rho * std::cos(a), shell_radius * rho * std::sin(a), shell_radius * z},
         ball_radius});
  }
  return SphereSet(std::move(spheres));
}

SphereSet cluster(int count, unsigned seed) {
  std::mt19937 random(seed);
  const double half = 0.7 * std::cbrt(static_cast<double>(count));
  const auto in = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    const double x = in(-half, half), y = in(-half, half), z = in(-half, half);
    spheres.push_back({{x, y, z}, in(1.2, 1.9)});
  }
  return SphereSet(std::move(spheres));
}

SphereSet translated(const SphereSet& spheres, const Vec3d& by) {
  std::vector<Sphere> moved;
  for (const Sphere& s : spheres.spheres()) moved.push_back({s.center + by, s.radius});
  return SphereSet(std::move(moved));
}

SphereSet permuted(const SphereSet& spheres, const std::vector<SphereId>& order) {
  std::vector<Sphere> result;
  for (const SphereId id : order) result.push_back(spheres[id]);
  return SphereSet(std::move(result));
}

void expect_permuted(const SphereSet& spheres, const ExtractResult& original,
                     const ExtractResult& shuffled, const std::vector<SphereId>& order) {
  ASSERT_EQ(original.mesh.vertex_count(), shuffled.mesh.vertex_count());
  const IndexedMeshHash one = hash(original.mesh), other = hash(shuffled.mesh);
  EXPECT_EQ(one.positions, other.positions);
  EXPECT_EQ(one.normals, other.normals);
  EXPECT_EQ(one.triangles, other.triangles);
  for (std::size_t v = 0; v < original.mesh.vertex_count(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const SphereId mine = original.mesh.vertex_spheres[v][k];
      const SphereId theirs = shuffled.mesh.vertex_spheres[v][k];
      ASSERT_EQ(theirs == kNoSphere, mine == kNoSphere) << "vertex " << v;
      if (mine == kNoSphere) continue;
      const Sphere &a = spheres[mine], &b = spheres[order[theirs]];
      ASSERT_TRUE(a.center == b.center && a.radius == b.radius) << "vertex " << v;
    }
  }
}

}  // namespace vdwmesh::testing
