// The kernel that meshes patches, alone, beside the host's threads on the same patches.
//
//   patches_bench [--edge-length H] STRUCTURE...
//
// For each structure and each order of the crease-exact mesher, patches whose boundaries have come
// to rest: how much memory they take, how long the host needs for them on all its threads, and how
// long the kernel with 1 to 32 patches for each warp. Results are compared bit by bit.
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "creases/share/patch_batch.hpp"
#include "creases/share/patch_device.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/transfer.cuh"
#include "cuda/mesher/mesh_patches.cuh"
#include "read_xyzr.hpp"

namespace vdwmesh {
namespace {

template <class T>
std::vector<T> download(const T* from, std::size_t count, const Stream& stream) {
  std::vector<T> to(count);
  download_parts({{to.data(), from, count * sizeof(T)}}, stream);
  return to;
}

// Whether two arrays have the same bytes.
template <class A, class B>
bool same(const A& a, const B& b) {
  static_assert(std::is_same_v<typename A::value_type, typename B::value_type>);
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

// Takes the jobs of the mesher, measures, and gives the host's results back.
class MeasuringDevice final : public PatchDevice {
 public:
  // Looks at the jobs all the time, so that the host waits.
  void mesh(const PatchOrder& order) override {
    order.look([&] {
      // Of the largest sets, as much as fits one batch; none of those withdrawn.
      std::vector<PatchJob> some;
      for (PatchJob& job : order.jobs) {
        job.is_begun = true;
        if (!job.is_withdrawn && some.size() < (std::size_t{1} << 16))
          some.push_back(std::move(job));
      }
      const double host = mesh_on_host(some);
      std::size_t triangles = 0;
      for (const PatchMesh& mesh : meshes_) triangles += mesh.triangles.size();
      mesh_on_device(some, host, triangles);
    });
  }
  void look(const LookOrder&) override {}  // all boundaries are left to the host
  std::size_t threads() const override { return 1; }
  std::uint64_t batches() const override { return 0; }
  void place(const PatchPlaces&, IndexedMesh&) override {}  // it keeps nothing
  bool keeps_mesh() const override { return false; }
  void assemble(const MeshToAssemble&) override {}
  void forget() override {}

 private:
  double mesh_on_host(std::span<PatchJob> jobs) {
    meshes_.assign(jobs.size(), {});
    tbb::enumerable_thread_specific<PatchScratch> scratch;
    const auto begin = std::chrono::steady_clock::now();
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
      PatchProgress progress = *jobs[i].progress;
      meshes_[i] = mesh_patch(progress,
                              {jobs[i].edge_length, jobs[i].demand, PatchStage::triangles, nullptr},
                              scratch.local());
    });
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void mesh_on_device(std::span<PatchJob> jobs, double host, std::size_t host_triangles) {
    std::vector<std::uint32_t> which;
    for (std::uint32_t j = 0; j < jobs.size(); ++j) {
      if (is_for_device(jobs[j].sizes)) which.push_back(j);
    }
    const PatchBatch batch(jobs, which);
    const auto count = static_cast<std::uint32_t>(batch.patches().size());
    std::vector<std::byte> input(batch.input_bytes());
    batch.pack(input.data());
    const Stream stream;
    const DeviceArray<std::byte> device_input(input.size(), stream),
        work(batch.work_bytes(), stream);
    const DeviceArray<BoundedPatch> patches(count, stream);
    const DeviceArray<Vec3d> lattice(batch.lattice().size(), stream);
    const DeviceArray<PatchOutcome> outcomes(count, stream);
    upload_parts({{device_input.data(), input.data(), input.size()},
                  {patches.data(), batch.patches().data(), patches.bytes()},
                  {lattice.data(), batch.lattice().data(), lattice.bytes()}},
                 stream);
    std::printf(
        "%u of %zu patches, %.0f MB of input, %.0f MB of work memory; host %.4f s, %zu "
        "triangles\n",
        count, jobs.size(), 1e-6 * static_cast<double>(input.size()),
        1e-6 * static_cast<double>(batch.work_bytes()), host, host_triangles);
    for (const unsigned per_warp : {1u, 2u, 4u, 8u, 16u, 32u}) {
      float best = 1e30F;
      for (int run = 0; run < 3; ++run) {
        StageClock clock(stream);
        mesher::mesh_patches(patches.data(), count,
                             {device_input.data(), work.data(), lattice.data()}, outcomes.data(),
                             per_warp, stream);
        best = std::min(best, clock.lap());
      }
      std::printf("%3u patches a warp: %8.2f ms, %.1f million triangles/s, ", per_warp, best,
                  1e-3 * static_cast<double>(host_triangles) / best);
      compare(batch, download(outcomes.data(), count, stream), stream);
    }
  }

  // `compare` looks at some 2,000 patches, since each is fetched by itself.
  void compare(const PatchBatch& batch, const std::vector<PatchOutcome>& outcomes,
               const Stream& stream) const {
    std::size_t no_room = 0, undecided = 0, compared = 0, other = 0;
    const std::size_t stride = outcomes.size() / 2000 + 1;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
      const PatchOutcome& o = outcomes[i];
      no_room += o.failure == PatchFailure::no_room;
      undecided += o.failure == PatchFailure::undecided;
      if (o.failure != PatchFailure::none || i % stride != 0) continue;
      const PatchMesh& mesh = meshes_[batch.job(i)];
      const std::vector<PieceSplit> found = download(o.first_split, o.splits, stream);
      PatchVector<PieceSplit> splits(found.begin(), found.end());
      sort_requests(splits);
      ++compared;
      other += !(same(download(o.first_interior, o.interior, stream), mesh.interior) &&
                 same(download(o.first_triangle, o.triangles, stream), mesh.triangles) &&
                 same(splits, mesh.splits));
    }
    std::printf("no room %zu, undecided %zu, compared %zu, different %zu\n", no_room, undecided,
                compared, other);
  }

  std::vector<PatchMesh> meshes_;  // of the host, by job
};

}  // namespace
}  // namespace vdwmesh

int main(int argc, char** argv) {
  vdwmesh::ExactMeshOptions options{.device_work = vdwmesh::DeviceWork::all};
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--edge-length" && i + 1 < argc) {
      options.edge_length = std::stod(argv[++i]);
      continue;
    }
    std::printf("%s, %g Å\n", argv[i], options.edge_length);
    vdwmesh::MeasuringDevice device;
    vdwmesh::mesh_union_with(&device, vdwmesh::SphereSet(vdwmesh::read_xyzr(argv[i])), options);
  }
  return 0;
}
