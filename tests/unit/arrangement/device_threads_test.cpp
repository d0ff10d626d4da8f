// Two threads that feed a device of the crease-exact mesher at the same time: the mesh has the bits
// of the host's, whoever takes which patches, and what one of them throws is thrown.
#include <gtest/gtest.h>

#include <vector>

#include "core/errors.hpp"
#include "creases/exact_mesher.hpp"
#include "support/dice.hpp"
#include "support/hosted_device.hpp"

namespace vdwmesh::testing {
namespace {

// Balls in a loose cloud, nearly all with a patch: enough that both threads get some.
SphereSet cloud(int count) {
  Dice dice(31);
  std::vector<Sphere> balls;
  for (int i = 0; i < count; ++i) {
    balls.push_back({{dice.real(0, 60), dice.real(0, 60), dice.real(0, 60)}, dice.real(1.5, 2.5)});
  }
  return SphereSet(balls);
}

const ExactMeshOptions kCoarse{.edge_length = 1.5, .device_work = DeviceWork::all};

TEST(DeviceThreads, ShareWhatWasSent) {
  const SphereSet spheres = cloud(3000);
  const ExactMesh expected = mesh_union(spheres, kCoarse);
  for (const bool is_keeper : {false, true}) {
    HostedDevice device;
    device.thread_count = 2;
    device.is_keeper = is_keeper;
    const ExactMesh made = mesh_union_with(&device, spheres, kCoarse);
    EXPECT_EQ(hash(is_keeper ? *device.assembled : made.mesh), hash(expected.mesh));
    EXPECT_GT(made.stats.device_batches, 1u);
    EXPECT_EQ(device.broken_guards, 0u);
  }
}

// Whichever of the first batches fails, the others end, and nothing waits for ever.
TEST(DeviceThreads, ThrowWhatOneHasThrown) {
  const SphereSet spheres = cloud(3000);
  for (const std::uint64_t failing : {1u, 2u}) {
    HostedDevice device;
    device.thread_count = 2;
    device.failing_batch = failing;
    EXPECT_THROW(mesh_union_with(&device, spheres, kCoarse), InvalidInput) << failing;
  }
}

}  // namespace
}  // namespace vdwmesh::testing
