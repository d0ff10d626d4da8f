// Distances on every backend: closed forms, the definition as the reference, determinism, and input
// that must be refused.
#include "analysis/distance_measurer.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "contract/extractor_contract.hpp"
#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "support/ball_families.hpp"
#include "support/dice.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh::testing {
namespace {

// Å. Some 100 roundings of lengths of a few Å; the square of a length is what is compared.
constexpr double kRounding = 1e-12;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class DistanceMeasurerContract : public BackendTest, public ::testing::WithParamInterface<Backend> {
 protected:
  void SetUp() override { need(GetParam()); }
  MeshDistances measure(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options = {}) const {
    const MeasuredDistances measured =
        make_distance_measurer(GetParam())->measure(mesh, spheres, options);
    EXPECT_EQ(measured.fallback, "");
    return measured.result;
  }
  std::vector<double> measure(const std::vector<Vec3d>& points, const SphereSet& spheres) const {
    return make_distance_measurer(GetParam())->measure_points(points, spheres).result;
  }
};
VDWMESH_INSTANTIATE_BACKENDS(DistanceMeasurerContract);

SphereSet unit_ball() { return SphereSet({{{0, 0, 0}, 1}}); }

bool same_bits(const MeshDistances& a, const MeshDistances& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST_P(DistanceMeasurerContract, PointsAboutOneBall) {
  Dice dice(1);
  std::vector<Vec3d> points{{0, 0, 0}, {1, 0, 0}, {0, -2.5, 0}};
  for (int i = 0; i < 500; ++i) points.push_back(random_point(dice, 3));
  const std::vector<double> found = measure(points, unit_ball());
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    EXPECT_NEAR(found[i], std::hypot(p.x, p.y, p.z) - 1, kRounding) << i;
  }
}

// Two unit balls at (±h, 0, 0). The nearest exposed point of a point between them, near the axis
// through both centres, is on the circle x = 0 of radius √(1 - h²).
TEST_P(DistanceMeasurerContract, PointsInACreaseAreNearestToItsCircle) {
  const double h = 0.6, circle = std::sqrt(1 - h * h);
  const SphereSet balls({{{-h, 0, 0}, 1}, {{h, 0, 0}, 1}});
  Dice dice(2);
  std::vector<Vec3d> points;
  for (int i = 0; i < 300; ++i) {
    // As seen from either centre, the crease is at an angle whose cosine is h from the axis.
    const double x = dice.real(-0.3, 0.3), out = dice.real(0, 0.4), angle = dice.real(0, 6.28);
    points.push_back({x, out * std::cos(angle), out * std::sin(angle)});
  }
  const std::vector<double> found = measure(points, balls);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3d& p = points[i];
    EXPECT_NEAR(found[i], -std::hypot(p.x, circle - std::hypot(p.y, p.z)), kRounding) << i;
  }
}

TEST_P(DistanceMeasurerContract, NoPointsHaveNoDistances) {
  EXPECT_TRUE(measure(std::vector<Vec3d>{}, unit_ball()).empty());
}

// A sphere of radius 1.5 about the unit ball, finely meshed: every distance is 1/2, but for what
// triangles of edge e = 1.5 / 16 leave off, e² / (8 · 1.5) and less.
TEST_P(DistanceMeasurerContract, ConcentricSpheres) {
  const IndexedMesh mesh = scaled(icosphere(4), 1.5);
  const MeshDistances d = measure(mesh, unit_ball());
  constexpr double kSagitta = 1.5e-3, kBin = 1.0 / 256;  // Å, and relative
  for (const DistanceStatistics& s : {d.mesh_to_surface, d.surface_to_mesh}) {
    for (const double figure : {s.mean, s.rms, s.max}) EXPECT_NEAR(figure, 0.5, kSagitta);
    for (const double figure : {s.p50, s.p95, s.p99}) EXPECT_NEAR(figure, 0.5, 0.5 * kBin);
  }
  EXPECT_NEAR(d.mesh_to_surface.max, 0.5, kRounding);  // at the vertices
  // 10 samples per Å², 10^4 at least, and vertices and centres beside them.
  EXPECT_EQ(d.mesh_to_surface.samples, 10000 + mesh.vertex_count() + mesh.triangle_count());
  EXPECT_EQ(d.samples, d.mesh_to_surface.samples + d.surface_to_mesh.samples);
}

// A triangle far out, of an area that is hardly any, is measured like the others.
TEST_P(DistanceMeasurerContract, SmallTrianglesAndIsolatedVertices) {
  IndexedMesh mesh = icosphere(2);
  const double plain = measure(mesh, unit_ball()).mesh_to_surface.max;
  const auto samples = measure(mesh, unit_ball()).mesh_to_surface.samples;
  mesh.positions.push_back({7, 0, 0});
  const MeshDistances isolated = measure(mesh, unit_ball());
  EXPECT_EQ(isolated.mesh_to_surface.max, plain);
  EXPECT_EQ(isolated.mesh_to_surface.samples, samples);
  const auto last = static_cast<std::uint32_t>(mesh.vertex_count() - 1);
  mesh.triangles.push_back({last, last, last});
  const MeshDistances spike = measure(mesh, unit_ball());
  EXPECT_NEAR(spike.mesh_to_surface.max, 6, kRounding);
  EXPECT_EQ(spike.mesh_to_surface.samples, samples + 2);
}

// The distances of a mesh moved off by t lie within its diameters of t.
TEST_P(DistanceMeasurerContract, MeshesFarOffAndInsideOut) {
  const IndexedMesh mesh = scaled(icosphere(3), 1.1);
  for (const double off : {1e4, 1e8, 1e12}) {
    const MeshDistances far = measure(translated(mesh, {off, 0, 0}), unit_ball());
    const double slack = 2.2 + off * 1e-15;
    for (const DistanceStatistics& d : {far.mesh_to_surface, far.surface_to_mesh})
      for (const double figure : {d.mean, d.rms, d.max}) EXPECT_NEAR(figure, off, slack);
  }
  const MeshDistances out = measure(mesh, unit_ball()), in = measure(reversed(mesh), unit_ball());
  EXPECT_NEAR(in.surface_to_mesh.mean, out.surface_to_mesh.mean, kRounding);
}

IndexedMesh shells_about(const std::vector<Sphere>& balls, Dice& dice) {
  IndexedMesh mesh;
  for (const Sphere& ball : balls) {
    const double radius = ball.radius * dice.real(0.9, 1.2);
    mesh = together(mesh, translated(scaled(icosphere(dice.whole(0, 2)), radius), ball.center));
  }
  return mesh;
}

TEST_P(DistanceMeasurerContract, SameBitsAgainAndForSpheresInAnyOrder) {
  Dice dice(3);
  const std::vector<Sphere> balls = dense_heap(dice);
  const IndexedMesh mesh = shells_about(balls, dice);
  const MeshDistances first = measure(mesh, SphereSet(balls));
  EXPECT_TRUE(same_bits(first, measure(mesh, SphereSet(balls))));
  const std::vector<Sphere> reversed(balls.rbegin(), balls.rend());
  EXPECT_TRUE(same_bits(first, measure(mesh, SphereSet(reversed))));
  EXPECT_FALSE(same_bits(first, measure(mesh, SphereSet(balls), {.seed = 2})));
}

template <class Error, class Call>
void expect_refused(const Call& call, const std::string& reason) {
  try {
    call();
    ADD_FAILURE() << "accepted; expected: " << reason;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST_P(DistanceMeasurerContract, RefusesWhatHasNoDistances) {
  const IndexedMesh good = icosphere(2);
  expect_refused<InvalidInput>([&] { measure(IndexedMesh{}, unit_ball()); }, "no triangles");
  expect_refused<InvalidInput>([&] { measure(good, SphereSet()); }, "no spheres");
  expect_refused<InvalidInput>([&] { measure({{0, 0, 0}}, SphereSet()); }, "no spheres");
  expect_refused<InvalidInput>(
      [&] {
        measure({{0, 0, 0}, {kNaN, 0, 0}}, unit_ball());
      },
      "point 1 is not finite");
  IndexedMesh broken = good;
  broken.positions[9].y = broken.positions[7].y = kNaN;
  expect_refused<InvalidInput>([&] { measure(broken, unit_ball()); }, "vertex 7");
  IndexedMesh stray = good;
  stray.triangles[3][1] = 1000;
  expect_refused<InvalidInput>([&] { measure(stray, unit_ball()); },
                               "triangle 3 names vertex 1000");
  expect_refused<InvalidInput>([&] { measure(scaled(good, 0), unit_ball()); }, "no area");
  for (const double samples : {0.0, -1.0, kNaN}) {
    expect_refused<InvalidInput>([&] { measure(good, unit_ball(), {.samples_per_area = samples}); },
                                 "samples");
  }
  expect_refused<LimitExceeded>([&] { measure(good, unit_ball(), {.samples_per_area = 1e15}); },
                                "samples");
  expect_refused<LimitExceeded>([&] { measure(good, unit_ball(), {.memory_limit = 1000}); },
                                "1000 are allowed");
}

// Asks to stop in the stage whose name begins so.
class StopsIn final : public Monitor {
 public:
  explicit StopsIn(std::string stage) : stage_(std::move(stage)) {}
  void begin_stage(std::string_view name, std::uint64_t) override {
    stops_ = stops_ || name.starts_with(stage_);
  }
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return stops_; }

 private:
  std::string stage_;
  std::atomic<bool> stops_ = false;
};

TEST_P(DistanceMeasurerContract, StopsWhenAsked) {
  const IndexedMesh mesh = icosphere(3);
  for (const char* stage :
       {"exposed surface", "distances of the mesh", "distances of the surface"}) {
    StopsIn monitor(stage);
    EXPECT_THROW(measure(mesh, unit_ball(), {.monitor = &monitor}), Cancelled) << stage;
  }
  StopsIn monitor("signed distances");
  EXPECT_THROW(
      make_distance_measurer(GetParam())->measure_points(mesh.positions, unit_ball(), &monitor),
      Cancelled);
}

}  // namespace
}  // namespace vdwmesh::testing
