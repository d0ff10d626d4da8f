// A device of the crease-exact mesher on the host: what a GPU does, in memory like a GPU's, with
// guards around it, and without a GPU.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "creases/share/look_batch.hpp"
#include "creases/share/mesh_placement.hpp"
#include "creases/share/patch_batch.hpp"
#include "creases/share/patch_device.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

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
    {
      const std::lock_guard lock(mutex_);
      if (++batches_ == failing_batch) throw InvalidInput("this device fails");
      for (const PatchJob& job : order.jobs) sent_again += !balls_.insert(job.ball).second;
    }
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
      if (j == 0 && std::exchange(waits, false)) wait_for_withdrawals(order);
      const std::lock_guard lock(mutex_);
      patches += batch->patches().size();
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
      write(kept_[to.kept], to, all, mesh);
      ++placed;
    }
  }

  // Puts the mesh together into `assembled`, if `is_keeper`.
  bool keeps_mesh() const override { return is_keeper; }
  void assemble(const MeshToAssemble& parts) override {
    IndexedMesh& mesh = assembled.emplace();
    make_room(mesh, parts.size, {.labels = TriangleLabels::spheres, .width = LabelWidth::three});
    parts.boundary.place_corners(mesh);
    parts.boundary.place_arcs(mesh);
    place(parts.kept, mesh);
    for (const PatchOfHost& of_host : parts.of_host) {
      write(*of_host.patch, of_host.place, parts.kept, mesh);
      ++placed_of_host;
    }
  }

  std::size_t threads() const override { return thread_count; }
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
  std::size_t thread_count = 1;
  std::uint64_t failing_batch = 0;  // the number, from 1, of the call of mesh() that fails; 0: none
  bool is_keeper = false;
  std::optional<IndexedMesh> assembled;
  std::size_t placed = 0, placed_of_host = 0, patches = 0, sent_again = 0;
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

  template <class Patch>
  static void write(const Patch& patch, const PatchPlace& to, const PatchPlaces& all,
                    IndexedMesh& mesh) {
    std::vector<std::uint32_t> vertices;
    for (const PointSource& source : patch.sources) {
      vertices.push_back(source.vertex(all.first_vertices.data()));
    }
    ASSERT_EQ(patch.interior.size(), to.interior);
    for (std::size_t k = 0; k < patch.interior.size(); ++k) {
      const std::size_t v = to.first_vertex + k;
      mesh.positions[v] = all.unit * (to.sphere.center + to.sphere.radius * patch.interior[k]);
      mesh.normals[v] = cast<float>(patch.interior[k]);
      mesh.vertex_spheres.set(v, on_sphere(to.id));
      vertices.push_back(static_cast<std::uint32_t>(v));
    }
    ASSERT_EQ(patch.triangles.size(), to.triangles);
    for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
      const auto& [a, b, c] = patch.triangles[t];
      mesh.triangles[to.first_triangle + t] = {vertices[a], vertices[b], vertices[c]};
      mesh.triangle_spheres[to.first_triangle + t] = to.id;
    }
  }

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
  std::mutex mutex_;  // for the counters and what is kept
  double room_;
  std::uint64_t batches_ = 0;
  std::vector<Kept> kept_;         // by PatchJob::kept
  std::set<std::uint32_t> balls_;  // of all jobs
};

}  // namespace vdwmesh::testing
