// Neither place, order nor threads change the mesh: random sets of fixed seeds, of which most are
// degenerate. All lengths are whole multiples of 2^-6 Å, so a shift by whole numbers is exact and
// the moved mesh must be the same, triangle by triangle.
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "contract/extractor_contract.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

class PropertiesInvariance : public ExtractorContract {};

constexpr unsigned kSets = 500;

SphereSet random_set(Dice& dice) {
  const double unit = dice.one_in(2) ? 0.5 : 1.0 / 64;  // Å; 0.5: tangent, nested, on nodes
  const int reach = static_cast<int>(dice.real(1.5, 4) / unit);
  const int largest = static_cast<int>(2 / unit);
  std::vector<Sphere> spheres(static_cast<std::size_t>(dice.whole(1, 25)));
  for (Sphere& s : spheres) {
    const auto place = [&] { return unit * dice.whole(-reach, reach); };
    const double x = place(), y = place(), z = place();
    s = {{x, y, z}, unit * dice.whole(1, largest)};
  }
  return SphereSet(std::move(spheres));
}

ExtractOptions random_options(Dice& dice) {
  ExtractOptions options;
  options.grid.spacing = dice.one_in(2) ? 0.5 : 0.25;
  options.field.kind = static_cast<FieldKind>(dice.whole(0, 3));
  options.connectivity = dice.one_in(2) ? Connectivity::half_edges : Connectivity::triangles;
  return options;
}

void expect_moved(const ExtractResult& here, const ExtractResult& there, const Vec3d& by) {
  const IndexedMeshHash a = hash(here.mesh), b = hash(there.mesh);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.vertex_spheres, b.vertex_spheres);
  constexpr double kRounding = 1e-12;  // Å: a few units in the last place of a coordinate of 1000
  for (std::size_t v = 0; v < here.mesh.vertex_count(); ++v) {
    const Vec3d difference = there.mesh.positions[v] - here.mesh.positions[v] - by;
    ASSERT_TRUE(norm(difference) <= kRounding) << "vertex " << v;
  }
}

std::vector<SphereId> random_order(std::size_t count, unsigned seed) {
  std::vector<SphereId> order(count);
  std::iota(order.begin(), order.end(), SphereId{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

TEST_P(PropertiesInvariance, PlaceOrderAndThreadsDoNotMatter) {
  for (unsigned seed = 1; seed <= kSets && !HasFailure(); ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Dice dice(seed);
    const SphereSet spheres = random_set(dice);
    const ExtractOptions options = random_options(dice);
    const ExtractResult result = extract(spheres, options);
    if (!result.mesh.triangles.empty()) expect_sound(result, "as it is", options.connectivity);
    const Vec3d by{128, -256, 512};
    expect_moved(result, extract(translated(spheres, by), options), by);
    const auto order = random_order(spheres.size(), seed);
    expect_permuted(spheres, result, extract(permuted(spheres, order), options), order);
    for (const std::size_t threads : {1u, 3u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(hash(extract(spheres, options).mesh), hash(result.mesh)) << threads << " threads";
    }
  }
}

VDWMESH_INSTANTIATE_BACKENDS(PropertiesInvariance);

}  // namespace
}  // namespace vdwmesh::testing
