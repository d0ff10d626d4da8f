// What a device is given: batches of looks and of patches that fit its memory, and which of the
// patches are its, and which the host's. No GPU is needed.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "creases/share/look_batch.hpp"
#include "creases/share/patch_batch.hpp"
#include "creases/share/patch_device.hpp"

namespace vdwmesh::testing {
namespace {

TEST(FirstLooks, FitTheirMemoryAndHaveFewPoints) {
  std::vector<PatchProgress> progress(2);
  progress[0].boundary.points.resize(513);
  progress[1].boundary.points.resize(512);
  const std::vector<LookJob> jobs{{&progress[0], 1, 1}, {&progress[1], 1, 1}};
  const LookBatch all(jobs, ~std::uint64_t{0});
  ASSERT_EQ(all.looks().size(), 1u);
  EXPECT_EQ(all.job(0), 1u);
  // What a look says of itself and its requests count, too.
  const std::uint64_t arrays = all.input_bytes() + all.state_bytes() + all.work_bytes();
  EXPECT_TRUE(LookBatch(jobs, arrays).looks().empty());
}

// However little memory there is, no batch takes more, and no job is in two. What needs more than a
// batch may have is in none, and so is a job that is withdrawn.
TEST(DeviceBatches, FitTheirMemory) {
  std::vector<PatchProgress> progress(3);
  std::vector<PatchJob> jobs(2000);
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    const std::uint32_t kind = j % 3;
    progress[kind].boundary.points.resize(20 + 30 * kind);
    jobs[j].progress = &progress[kind];
    jobs[j].edge_length = 0.2 + 0.1 * kind;
    jobs[j].area = 1;
    jobs[j].is_withdrawn = j % 7 == 0;
    jobs[j].sizes = sizes_of(jobs[j]);
    ASSERT_TRUE(is_for_device(jobs[j].sizes));
  }
  // Icosahedra have points for each of the three edge lengths.
  const auto bytes_of = [&](const std::vector<std::uint32_t>& batch) {
    std::set<double> lengths;
    std::uint64_t bytes = 0;
    for (const std::uint32_t j : batch) {
      bytes += device_bytes(jobs[j].sizes);
      if (!lengths.insert(jobs[j].edge_length).second) continue;
      SpherePoints lattice;
      bytes += lattice.points(jobs[j].edge_length).size() * sizeof(Vec3d);
    }
    return bytes;
  };
  const std::uint64_t one = bytes_of({1});
  std::size_t before = 0;
  for (const std::uint64_t most :
       {std::uint64_t{0}, one - 1, one, 2 * one, 100 * one, 10'000 * one}) {
    SCOPED_TRACE(most);
    std::set<std::uint32_t> given;
    for (const std::vector<std::uint32_t>& batch : batches_of(jobs, most)) {
      EXPECT_FALSE(batch.empty());
      EXPECT_LE(bytes_of(batch), most);
      for (const std::uint32_t j : batch) {
        EXPECT_FALSE(jobs[j].is_withdrawn);
        EXPECT_TRUE(given.insert(j).second);
      }
    }
    EXPECT_GE(given.size(), before);
    before = given.size();
  }
  EXPECT_EQ(before, jobs.size() - (jobs.size() + 6) / 7);
  EXPECT_EQ(batches_of(jobs, 10'000 * one).size(), 1u);
}

// Patches of 100 to 699 points.
std::vector<std::uint32_t> sizes_of_patches(std::size_t count) {
  std::vector<std::uint32_t> sizes(count);
  for (std::size_t i = 0; i < count; ++i) {
    sizes[i] = 100 + static_cast<std::uint32_t>(7919 * i % 600);
  }
  return sizes;
}

// Few patches are for the host, many for the device, and between them cores leave it fewer, the
// smallest.
TEST(PatchesForDevice, DependOnTheNumberOfPatchesAndOfCores) {
  EXPECT_EQ(load_for_device({}, HostWork::rounds).most_points, 0u);
  EXPECT_EQ(load_for_device(sizes_of_patches(1000), HostWork::rounds).most_points, 0u);
  EXPECT_EQ(load_for_device(sizes_of_patches(100'000), HostWork::rounds).most_points, 699u);
  for (const std::size_t count : {2000u, 4556u, 16'000u}) {
    DeviceLoad before{699, 1e300};
    for (const std::size_t cores : {1u, 2u, 4u, 8u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, cores);
      const DeviceLoad load = load_for_device(sizes_of_patches(count), HostWork::rounds);
      EXPECT_LE(load.most_points, before.most_points) << count << " patches, cores " << cores;
      EXPECT_LT(load.milliseconds, before.milliseconds) << count << " patches, cores " << cores;
      EXPECT_GT(load.milliseconds, 0) << count << " patches, cores " << cores;
      before = load;
    }
  }
}

// Of many patches the host meshes some too, once it has no rounds left.
TEST(PatchesForDevice, AreSharedOnceTheHostHasNoRounds) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
  const DeviceLoad alone = load_for_device(sizes_of_patches(100'000), HostWork::rounds);
  const DeviceLoad shared = load_for_device(sizes_of_patches(100'000), HostWork::patches);
  EXPECT_GT(shared.most_points, 100u);
  EXPECT_LT(shared.most_points, alone.most_points);
  EXPECT_LT(shared.milliseconds, alone.milliseconds);
}

// The later it can begin, the less it gets.
TEST(PatchesForDevice, ABusyDeviceGetsFewer) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
  std::uint32_t before = 699;
  for (const double busy : {0.0, 10.0, 20.0, 40.0}) {
    const std::uint32_t most_points =
        load_for_device(sizes_of_patches(4556), HostWork::rounds, busy).most_points;
    EXPECT_LE(most_points, before);
    before = most_points;
  }
  EXPECT_LT(before, load_for_device(sizes_of_patches(4556), HostWork::rounds).most_points);
  EXPECT_EQ(load_for_device(sizes_of_patches(4556), HostWork::rounds, 1e9).most_points, 0u);
  EXPECT_EQ(busy_without(1, 100'000), 0);
  EXPECT_LT(busy_without(30, 1000), 30);
  EXPECT_EQ(busy_after(0, 1000), 0);
  EXPECT_EQ(busy_after(1, 1'000'000), 0);
  EXPECT_LT(busy_after(30, 1000), 30);
  EXPECT_GT(busy_after(30, 1000), 0);
}

}  // namespace
}  // namespace vdwmesh::testing
