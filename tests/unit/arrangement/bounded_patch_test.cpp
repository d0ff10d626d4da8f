// Patches meshed in bounded memory, as the device does it, but on the host: the same bits as in
// growing memory, or a failure. No GPU is needed.
#include "arrangement/mesher/bounded_patch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "arrangement/mesher/look_batch.hpp"
#include "arrangement/mesher/patch_batch.hpp"
#include "arrangement/mesher/patch_device.hpp"
#include "core/errors.hpp"
#include "support/dice.hpp"
#include "support/floor_sets.hpp"
#include "support/shared_files.hpp"
#include "support/sphere_recipes.hpp"
#include "support/xyzr.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {
namespace {

// Meshes the jobs one after another on the host, in memory like a device's, and keeps the results
// until they have a place in the mesh. With `room` other than 1, patches get more or less room than
// they are thought to need. It looks at two jobs at a time, so that some may be withdrawn before.
class HostedDevice final : public PatchDevice {
 public:
  explicit HostedDevice(double room = 1) : room_(room) {}

  // Looks at two boundaries at a time, if they fit, and at no other one.
  void look(const LookOrder& order) override {
    for (std::size_t first = 0; first < order.count; first += 2) {
      std::vector<LookJob> jobs;
      for (std::size_t i = first; i < std::min(order.count, first + 2); ++i) {
        jobs.push_back(order.begin(i));
      }
      const LookBatch batch(jobs, most_bytes_of_look);
      std::vector<std::byte> input(batch.input_bytes());
      batch.pack(input.data());
      for (std::size_t i = 0; i < batch.looks().size(); ++i) {
        look_at_one(order, first, batch, jobs, i, input.data());
      }
    }
  }

  void mesh(const PatchOrder& order) override {
    ++batches_;
    for (const PatchJob& job : order.jobs) sent_again += !balls_.insert(job.ball).second;
    for (std::uint32_t j = 0; j < order.jobs.size(); j += 2) {
      std::vector<std::uint32_t> which{j};
      if (j + 1 < order.jobs.size()) which.push_back(j + 1);
      std::optional<PatchBatch> batch;
      std::vector<std::byte> input;
      std::vector<PointSource> sources;
      order.look([&] {
        batch.emplace(order.jobs, which);
        for (const std::uint32_t k : which) order.jobs[k].is_begun = true;
        input.resize(batch->input_bytes());
        sources.resize(batch->first_sources().back());
        batch->pack(input.data());
        batch->pack_sources(order.sources, sources.data());
      });
      patches += batch->patches().size();
      if (j == 0 && std::exchange(waits, false)) wait_for_withdrawals(order);
      for (std::size_t i = 0; i < batch->patches().size(); ++i) {
        const std::span<const PointSource> of_patch(
            sources.data() + batch->first_sources()[i],
            batch->first_sources()[i + 1] - batch->first_sources()[i]);
        mesh_one(batch->patches()[i], input.data(), batch->lattice().data(), of_patch,
                 order.jobs[batch->job(i)]);
      }
    }
  }

  void place(const PatchPlaces& all, IndexedMesh& mesh) override {
    for (const PatchPlace& to : all.places) {
      const Kept& patch = kept_[to.kept];
      std::vector<std::uint32_t> vertices;
      for (const PointSource& source : patch.sources) {
        vertices.push_back(source.vertex(all.first_vertices.data()));
      }
      for (std::size_t k = 0; k < patch.interior.size(); ++k) {
        const std::size_t v = to.first_vertex + k;
        mesh.positions[v] = all.unit * (to.sphere.center + to.sphere.radius * patch.interior[k]);
        mesh.normals[v] = cast<float>(patch.interior[k]);
        mesh.vertex_spheres.set(v, on_sphere(to.id));
        vertices.push_back(static_cast<std::uint32_t>(v));
      }
      for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
        const auto& [a, b, c] = patch.triangles[t];
        mesh.triangles[to.first_triangle + t] = {vertices[a], vertices[b], vertices[c]};
        mesh.triangle_spheres[to.first_triangle + t] = to.id;
      }
      ++placed;
    }
  }

  std::uint64_t batches() const override { return batches_; }

  void forget() override {
    batches_ = 0;
    kept_.clear();
    balls_.clear();
  }

  // Whether it begins no more than two jobs before half of its first ones are withdrawn, or some
  // seconds have passed.
  bool waits = false, was_waited_for = false;
  std::size_t most_kept = ~std::size_t{0};  // patches; it returns the others at once
  std::size_t placed = 0, patches = 0, sent_again = 0;
  std::size_t no_room = 0, undecided = 0, small_angle = 0, broken_guards = 0;
  // Of looks at boundaries: their memory, how many it did, and what became of them.
  std::uint64_t most_bytes_of_look = ~std::uint64_t{0};
  std::size_t looks = 0, undecided_looks = 0, not_simple = 0, no_room_looks = 0, other_looks = 0;

 private:
  struct Kept {
    std::vector<Vec3d> interior;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<PointSource> sources;
  };

  void wait_for_withdrawals(const PatchOrder& order) {
    for (int i = 0; i < 1000 && !was_waited_for; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      order.look([&] {
        const auto count = std::ranges::count_if(order.jobs, &PatchJob::is_withdrawn);
        was_waited_for = 2 * static_cast<std::size_t>(count) > order.jobs.size();
      });
    }
  }

  // Whether a look has left what the host's does, bit by bit. `before` is the progress before it.
  static bool is_as_on_host(PatchProgress before, const LookJob& job,
                            const PatchVector<PieceSplit>& splits) {
    PatchScratch scratch;
    PatchOptions options{.edge_length = job.edge_length};
    options.stage = PatchStage::boundary;
    options.area = job.area;
    const PatchMesh host = mesh_patch(before, options, scratch);
    const PlaneTypes::State &one = before.plane, &other = job.progress->plane;
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
    };
    return before.is_triangulated && job.progress->is_triangulated &&
           one.largest == other.largest && same(one.points, other.points) &&
           same(one.triangles, other.triangles) && same(one.star, other.star) &&
           host.splits == splits && host.exact_tests == 0;
  }

  void look_at_one(const LookOrder& order, std::size_t first, const LookBatch& batch,
                   const std::vector<LookJob>& jobs, std::size_t i, std::byte* input) {
    // Guards behind the work memory and behind the state.
    std::vector<std::byte> work(batch.work_bytes() + kGuard, std::byte{0x5a}),
        states(batch.state_bytes() + kGuard, std::byte{0x5a});
    const PatchOutcome out =
        look_at_boundary(batch.looks()[i], {input, states.data(), work.data()});
    for (const std::vector<std::byte>* memory : {&work, &states}) {
      broken_guards += std::any_of(memory->end() - kGuard, memory->end(),
                                   [](std::byte b) { return b != std::byte{0x5a}; });
    }
    ++looks;
    undecided_looks += out.failure == PatchFailure::undecided;
    not_simple += out.failure == PatchFailure::not_simple;
    no_room_looks += out.failure == PatchFailure::no_room;
    if (out.failure != PatchFailure::none) return;
    const LookJob& job = jobs[batch.job(i)];
    const PatchProgress before = *job.progress;
    PatchVector<PieceSplit> splits = batch.finish(i, states.data(), {out.first_split, out.splits});
    other_looks += !is_as_on_host(before, job, splits);
    order.end(first + batch.job(i), std::move(splits));
  }

  void mesh_one(BoundedPatch patch, std::byte* input, const Vec3d* lattice,
                std::span<const PointSource> sources, PatchJob& job) {
    patch.work = 0;
    // Never less than what the boundary takes.
    const double most = room_ * static_cast<double>(patch.sizes.most_points);
    patch.sizes.most_points = std::max(
        {patch.sizes.points, patch.sizes.plane_triangles / 2, static_cast<std::uint32_t>(most)});
    // Guards behind the work memory show whether anything was written beyond it.
    std::vector<std::byte> work(vdwmesh::work_bytes(patch.sizes) + kGuard, std::byte{0x5a});
    const PatchOutcome out = mesh_bounded_patch(patch, {input, work.data(), lattice});
    broken_guards += std::any_of(work.end() - kGuard, work.end(),
                                 [](std::byte b) { return b != std::byte{0x5a}; });
    no_room += out.failure == PatchFailure::no_room;
    undecided += out.failure == PatchFailure::undecided;
    small_angle += out.failure == PatchFailure::small_angle;
    if (out.failure != PatchFailure::none) return;
    job.is_done = true;
    if (out.splits > 0) {
      job.patch = std::make_unique<PatchMesh>();
      job.patch->splits.assign(out.first_split, out.first_split + out.splits);
      sort_requests(job.patch->splits);
    }
    if (kept_.size() == most_kept) {
      if (!job.patch) job.patch = std::make_unique<PatchMesh>();
      job.patch->interior.assign(out.first_interior, out.first_interior + out.interior);
      job.patch->triangles.assign(out.first_triangle, out.first_triangle + out.triangles);
      job.patch->sources.assign(sources.begin(), sources.end());
      return;
    }
    job.is_kept = out.triangles > 0;
    job.interior = out.interior;
    job.triangles = out.triangles;
    job.kept = kept_.size();
    kept_.push_back({{out.first_interior, out.first_interior + out.interior},
                     {out.first_triangle, out.first_triangle + out.triangles},
                     {sources.begin(), sources.end()}});
  }

  static constexpr std::ptrdiff_t kGuard = 64;
  double room_;
  std::uint64_t batches_ = 0;
  std::vector<Kept> kept_;         // by PatchJob::kept
  std::set<std::uint32_t> balls_;  // of all jobs
};

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

}  // namespace
}  // namespace vdwmesh::testing
