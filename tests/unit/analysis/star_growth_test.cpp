// How the judges of a mesh work at a vertex of valence n: a bipyramid of n triangles above and n
// below (support/growth.hpp).
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <vector>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "support/growth.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// With the apexes (0, 0, ±1), around a regular polygon of radius 3.
IndexedMesh bipyramid(int spokes) {
  IndexedMesh mesh;
  mesh.positions.push_back({0, 0, 1});
  mesh.positions.push_back({0, 0, -1});
  for (int i = 0; i < spokes; ++i) {
    const double turn = 2 * std::numbers::pi * i / spokes;
    mesh.positions.push_back({3 * std::cos(turn), 3 * std::sin(turn), 0});
  }
  const auto count = static_cast<std::uint32_t>(spokes);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % count;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

// A fan in an oblique plane, and one whose triangles each cross the next two.
IndexedMesh fan(int spokes, double width) {
  IndexedMesh mesh;
  mesh.positions.push_back({0.1, 0.2, 0.3});
  const auto at = [&](double place, double height) {
    const double turn = 2 * std::numbers::pi * place / spokes;
    const double x = 3 * std::cos(turn), y = 3 * std::sin(turn);
    return mesh.positions[0] + Vec3d{0.6 * x - 0.8 * y, 0.64 * x + 0.48 * y, 0.48 * x + height};
  };
  for (int i = 0; i < spokes; ++i) {
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(at(i, 0));
    mesh.positions.push_back(at(i + width, width > 1 ? 1e-3 : 0));
    mesh.triangles.push_back({0, next, next + 1});
  }
  return mesh;
}

// The boxes of all triangles of a quadrant have the hub in common, and those above it the axis with
// those below: a search by boxes asks sixteen times as often of four times as many.
TEST(StarGrowth, CrossingsTakeNLogN) {
  for (const int spokes : {1000, 2000}) {
    const auto grow = [spokes](const auto& make) {
      expect_growth(spokes, [&](int count, Monitor& monitor) {
        self_intersections(make(count), &monitor, MeshEdges::unknown);
      });
    };
    grow(bipyramid);
    grow([](int count) { return fan(count, 0.999); });
    grow([](int count) { return fan(count, 2.5); });
  }
  EXPECT_EQ(self_intersections(bipyramid(8000), nullptr, MeshEdges::paired), 0u);
}

class StopSoon : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return ++asked_ > kQuestions; }
  std::int64_t asked() const { return asked_; }

 private:
  static constexpr std::int64_t kQuestions = 1000;
  mutable std::atomic<std::int64_t> asked_{0};
};

// A search that takes long ends soon after it is asked to.
TEST(StarGrowth, CrossingsCanBeStopped) {
  StopSoon monitor;
  EXPECT_THROW(self_intersections(bipyramid(100'000), &monitor), Cancelled);
  EXPECT_LT(monitor.asked(), 2000);
}

// Points on slivers that all lead to one vertex: the search for the nearest triangle does not look
// at all of them.
TEST(StarGrowth, DistancesTakeNLogN) {
  expect_growth(2000, [](int spokes, Monitor& monitor) {
    const SphereSet ball(std::vector<Sphere>{{{0, 0, 0}, 2}});
    const MeshDistances found =
        distances(bipyramid(spokes), ball, {.samples_per_area = 10, .monitor = &monitor});
    EXPECT_GT(found.samples, 0u);
  });
}

// The figures of the bipyramid, whose edges are counted whatever the valence: χ is 2, and with n
// spokes the area tends to that of two cones of slant √10.
TEST(StarGrowth, MeasuresOfAHighValence) {
  constexpr int kSpokes = 100'000;
  const MeshSummary found = summarize(bipyramid(kSpokes));
  EXPECT_TRUE(found.topology.closed && found.topology.manifold && found.topology.oriented);
  EXPECT_EQ(found.topology.euler_characteristic, 2);
  EXPECT_EQ(found.topology.edges, 3u * kSpokes);
  const double cones = 2 * std::numbers::pi * 3 * std::sqrt(10.0);
  // A polygon of n sides falls short of its circle by 1 - cos(pi/n) or less.
  EXPECT_NEAR(found.measures.area, cones, 1e-9 * cones);
}

}  // namespace
}  // namespace vdwmesh::testing
