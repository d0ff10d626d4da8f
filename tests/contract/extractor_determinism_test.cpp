// The same bits for any number of threads, on every run; the same indices and labels everywhere.
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "contract/extractor_contract.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorFieldDeterminism : public ExtractorFieldContract {
 protected:
  ExtractResult with_threads(std::size_t threads, const SphereSet& spheres) const {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return extract(spheres, at_spacing(0.4));
  }
};

TEST_P(ExtractorFieldDeterminism, ThreadsDoNotMatter) {
  const SphereSet spheres = cluster(400, 41);
  const IndexedMeshHash one = hash(with_threads(1, spheres).mesh);
  for (const std::size_t threads : {2u, 3u, 8u}) {
    EXPECT_EQ(hash(with_threads(threads, spheres).mesh), one) << threads << " threads";
  }
  EXPECT_EQ(hash(with_threads(2, spheres).mesh), one) << "second run";
}

// Place of a vertex in the order of the handbook: brick, then node within it, both z-y-x, then
// axis.
std::array<std::uint64_t, 3> order_key(const GridSpec& grid, const Vec3d& p) {
  std::array<std::int64_t, 3> lattice{};
  std::uint64_t axis = 0;
  for (int a = 0; a < 3; ++a) {
    const double place = (p[a] - grid.origin[a]) / grid.spacing;
    const bool between = std::abs(place - std::round(place)) > 1e-9;
    if (between) axis = static_cast<std::uint64_t>(a);
    lattice[static_cast<std::size_t>(a)] =
        static_cast<std::int64_t>(between ? std::floor(place) : std::round(place)) + 1;
  }
  const auto part = [&](std::size_t a) {
    return static_cast<std::int32_t>(lattice[a] / kBrickSide);
  };
  const auto in_brick = [&](std::size_t a) {
    return static_cast<std::uint64_t>(lattice[a] % kBrickSide);
  };
  const std::uint64_t node = (in_brick(2) * kBrickSide + in_brick(1)) * kBrickSide + in_brick(0);
  return {brick_key({part(0), part(1), part(2)}), node, axis};
}

TEST_P(ExtractorFieldDeterminism, VerticesStandInTheOrderOfTheirGridEdges) {
  ExtractOptions cut = at_spacing(0.5);  // with vertices on the virtual layer's edges
  cut.grid.box = GridBox::centers;
  cut.grid.padding = 0.2;
  for (const ExtractOptions& options : {at_spacing(0.5), cut}) {
    const ExtractResult result = extract(cluster(200, 43), options);
    const auto& positions = result.mesh.positions;
    for (std::size_t v = 1; v < positions.size(); ++v) {
      ASSERT_LT(order_key(result.grid, positions[v - 1]), order_key(result.grid, positions[v]));
    }
  }
}

TEST_P(ExtractorFieldDeterminism, BackendsAgree) {
  if (std::get<0>(GetParam()) == Backend::cpu) GTEST_SKIP() << "the backend compared with";
  for (const SphereSet& spheres : {cluster(400, 42), hollow_shell(300, 6, 1.3)}) {
    const ExtractOptions options = at_spacing(0.4);
    const ExtractResult cpu = make_extractor(Backend::cpu)->extract(spheres, options);
    const ExtractResult device = extract(spheres, options);
    EXPECT_EQ(hash(device.mesh), hash(cpu.mesh));
    EXPECT_EQ(device.mesh.opposite, cpu.mesh.opposite);
    EXPECT_EQ(cpu.stats.clamped_vertices, device.stats.clamped_vertices);
    EXPECT_EQ(cpu.stats.grid_clipped, device.stats.grid_clipped);
    EXPECT_EQ(cpu.stats.surface_bricks, device.stats.surface_bricks);
  }
}

VDWMESH_INSTANTIATE_FIELDS(ExtractorFieldDeterminism);

}  // namespace
}  // namespace vdwmesh::testing
