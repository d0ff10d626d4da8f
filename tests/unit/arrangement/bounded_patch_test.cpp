// Patches meshed in bounded memory, as the device does it, but on the host: the same bits as in
// growing memory, or a failure. No GPU is needed.
#include "creases/plane/bounded_patch.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "support/dice.hpp"
#include "support/floor_sets.hpp"
#include "support/hosted_device.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// Returns the stats of the device's mesh.
ExactMeshStats expect_same_mesh(const SphereSet& spheres, double edge_length, HostedDevice& device,
                                DeviceWork work = DeviceWork::all) {
  ExactMeshOptions options;
  options.edge_length = edge_length;
  options.device_work = work;
  const ExactMesh one = mesh_union(spheres, options);
  const ExactMesh other = mesh_union_with(&device, spheres, options);
  EXPECT_EQ(hash(one.mesh), hash(other.mesh));
  EXPECT_EQ(one.stats.exact_tests, other.stats.exact_tests);
  EXPECT_EQ(one.stats.split, other.stats.split);
  EXPECT_EQ(device.broken_guards, 0u);
  EXPECT_EQ(device.other_looks, 0u);
  return other.stats;
}

class BoundedPatches : public ::testing::TestWithParam<const char*> {};

// With the room that a device gives, one patch in a thousand may fail, and one in 200 may have an
// angle that only the host enlarges.
TEST_P(BoundedPatches, SameBitsAndFewFailures) {
  const std::string file = "reference/" + std::string(GetParam()) + ".xyzr";
  VDWMESH_NEEDS_SHARED(file);
  std::size_t failed = 0, small_angle = 0, patches = 0, sent_again = 0, looks = 0, left = 0;
  for (const double probe : {0.0, 1.4}) {
    const SphereSet spheres = read_xyzr(shared_path(file), probe);
    for (const double edge_length : {0.5, 0.35, 0.2}) {
      SCOPED_TRACE(std::to_string(probe) + " " + std::to_string(edge_length));
      HostedDevice device;
      expect_same_mesh(spheres, edge_length, device);
      EXPECT_GT(device.placed, 0u);
      sent_again += device.sent_again;
      failed += device.no_room + device.undecided;
      small_angle += device.small_angle;
      patches += device.patches;
      looks += device.looks;
      left += device.undecided_looks + device.not_simple + device.no_room_looks;
    }
  }
  EXPECT_GT(patches, 0u);
  EXPECT_GT(looks, 0u);
  EXPECT_LE(100 * left, looks);
  // Some patches were sent while the rounds went on, withdrawn and sent anew.
  EXPECT_GT(sent_again, 0u);
  EXPECT_LE(1000 * failed, patches);
  EXPECT_LE(200 * small_angle, patches);
}
INSTANTIATE_TEST_SUITE_P(Molecules, BoundedPatches,
                         ::testing::Values("4PTI", "1EJG", "133D", "1HH0"),
                         [](const auto& each) { return std::string(each.param); });

// Whatever array is too small first, the patch fails without writing beyond its memory, and the
// host meshes it.
TEST(BoundedPatchFailures, TooLittleRoomIsNoticed) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  const SphereSet spheres = read_xyzr(shared_path("reference/1CRN.xyzr"));
  std::size_t last = 0;
  for (const double room : {0.8, 0.65, 0.5, 0.4, 0.0}) {
    SCOPED_TRACE(room);
    HostedDevice device(room);
    expect_same_mesh(spheres, 0.35, device);
    EXPECT_GE(device.no_room, last);
    last = device.no_room;
  }
  EXPECT_GT(last, 200u);
}

// Patches with a small angle in a sharp corner are the host's, which enlarges it.
TEST(BoundedPatchFailures, SmallAngles) {
  std::size_t small_angle = 0;
  for (const double degrees : {8.0, 3.0, 1.0, 0.3}) {
    for (const double k : {0.2, 0.3, 0.45}) {
      SCOPED_TRACE(std::to_string(degrees) + ", " + std::to_string(k));
      HostedDevice device;
      expect_same_mesh(strip(degrees, 0.2, k), 0.3, device);
      small_angle += device.small_angle;
    }
  }
  EXPECT_GT(small_angle, 0u);
}

// Balls that all but touch, meet in a point or share a circle have tests that double precision does
// not decide, and arcs that were joined.
TEST(BoundedPatchFailures, NearlyDegenerateSets) {
  std::size_t undecided = 0, undecided_looks = 0, not_simple = 0, patches = 0;
  for (unsigned seed = 17'000'000; seed < 17'000'096; ++seed) {
    const SeededSet set = seeded_set(seed);
    SCOPED_TRACE(seed);
    HostedDevice device;
    try {
      mesh_union(set.spheres, {set.edge_length});
    } catch (const LimitExceeded&) {
      EXPECT_THROW(mesh_union_with(&device, set.spheres, {set.edge_length}), LimitExceeded);
      continue;
    }
    expect_same_mesh(set.spheres, set.edge_length, device);
    undecided += device.undecided;
    undecided_looks += device.undecided_looks;
    not_simple += device.not_simple;
    patches += device.patches;
  }
  EXPECT_GT(patches, 500u);
  EXPECT_GT(undecided, 0u);
  EXPECT_GT(undecided_looks, 0u);
  EXPECT_GT(not_simple, 0u);
}

// Boundaries for which the device has no memory are the host's.
TEST(FirstLooks, TakeWhatFits) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  const SphereSet spheres = read_xyzr(shared_path("reference/1CRN.xyzr"));
  std::size_t last = ~std::size_t{0};
  for (const std::uint64_t bytes : {std::uint64_t{1} << 20, std::uint64_t{40'000},
                                    std::uint64_t{20'000}, std::uint64_t{1'000}}) {
    SCOPED_TRACE(bytes);
    HostedDevice device;
    device.most_bytes_of_look = bytes;
    expect_same_mesh(spheres, 0.35, device);
    EXPECT_LT(device.looks, last);
    last = device.looks;
  }
  EXPECT_EQ(last, 0u);
}

// A device that has hardly begun when the boundaries are settled: the host takes the others back,
// and both share them.
TEST(SharedPatches, TheHostTakesBackWhatIsNotBegun) {
  Dice dice(11);
  std::vector<Sphere> spheres;
  for (int site = 0; site < 900; ++site) {
    const Vec3d at{8.0 * (site % 10), 8.0 * (site / 10 % 10), 8.0 * (site / 100)};
    for (int i = 0; i < 4; ++i) {
      const Vec3d shift{dice.real(0, 2), dice.real(0, 2), dice.real(0, 2)};
      spheres.push_back({at + shift, dice.real(1, 1.8)});
    }
  }
  HostedDevice device;
  device.waits = true;
  expect_same_mesh(SphereSet(std::move(spheres)), 0.8, device, DeviceWork::balanced);
  EXPECT_TRUE(device.was_waited_for);
  EXPECT_GT(device.placed, 0u);
  EXPECT_GT(device.sent_again, 0u);
}

// A device without memory for all results: patches that it returns at once have the same places in
// the mesh. Of those that are split in the second series of rounds, the host begins anew, as of
// kept ones.
TEST(DeviceBatches, WhatIsNotKeptComesAtOnce) {
  VDWMESH_NEEDS_SHARED("reference/1EJG.xyzr");
  const SphereSet spheres = read_xyzr(shared_path("reference/1EJG.xyzr"));
  for (const std::size_t most_kept : {std::size_t{0}, std::size_t{1}, std::size_t{100}}) {
    SCOPED_TRACE(most_kept);
    HostedDevice device;
    device.most_kept = most_kept;
    const ExactMeshStats stats = expect_same_mesh(spheres, 0.35, device);
    EXPECT_LE(device.placed, most_kept);
    EXPECT_GT(stats.returned_patches, 300u);
    EXPECT_LE(stats.returned_patches, stats.device_patches);
    EXPECT_GT(stats.device_batches, 0u);
  }
  for (unsigned seed = 17'000'000; seed < 17'000'024; ++seed) {
    const SeededSet set = seeded_set(seed);
    if (sphere_recipes()[set.recipe].name == "pencils") continue;  // some are refused
    SCOPED_TRACE(seed);
    HostedDevice device;
    device.most_kept = 3;
    expect_same_mesh(set.spheres, set.edge_length, device);
  }
}

// A device that keeps the mesh puts together what it has meshed and what the host has. Where
// features were reduced to points, the host has the mesh all the same.
TEST(KeptMeshes, AreThoseOfTheHost) {
  VDWMESH_NEEDS_SHARED("reference/1CRN.xyzr");
  const SphereSet molecule = read_xyzr(shared_path("reference/1CRN.xyzr"));
  std::vector<Sphere> with_ball(molecule.spheres().begin(), molecule.spheres().end());
  with_ball.push_back({{100, 0, 0}, 1.5});  // a sphere without arcs
  for (const double room : {1.0, 0.5}) {
    const SphereSet spheres(with_ball);
    HostedDevice device(room);
    device.is_keeper = true;
    const ExactMeshOptions options{.device_work = DeviceWork::all};
    const ExactMesh left = mesh_union_with(&device, spheres, options);
    ASSERT_TRUE(device.assembled);
    EXPECT_EQ(left.mesh.triangle_count(), 0u);
    EXPECT_EQ(hash(*device.assembled), hash(mesh_union(spheres, options).mesh));
    EXPECT_GT(device.placed, 0u);
    EXPECT_GT(device.placed_of_host, room < 1 ? 100u : 0u);
  }
  // What the device could not keep came to the host at once, and goes back with the host's own.
  HostedDevice small;
  small.is_keeper = true;
  small.most_kept = 3;
  const ExactMeshOptions options{.device_work = DeviceWork::all};
  EXPECT_GT(mesh_union_with(&small, molecule, options).stats.returned_patches, 100u);
  EXPECT_GT(small.placed, 0u);
  EXPECT_LE(small.placed, 3u);  // fewer if one of them was split after all
  EXPECT_EQ(hash(*small.assembled), hash(mesh_union(molecule, options).mesh));
  const SphereSet touching({{{0, 0, 0}, 1}, {{2, 0, 0}, 1}, {{1, 1, 0}, 1}});
  HostedDevice device;
  device.is_keeper = true;
  const ExactMesh there = mesh_union_with(&device, touching, {.device_work = DeviceWork::all});
  const ExactMesh here = mesh_union(touching);
  EXPECT_GT(here.stats.points + here.stats.contacts + here.stats.joins, 0u);
  EXPECT_FALSE(device.assembled);
  EXPECT_EQ(hash(there.mesh), hash(here.mesh));
}

}  // namespace
}  // namespace vdwmesh::testing
