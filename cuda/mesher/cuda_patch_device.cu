// The crease-exact mesher with a CUDA device for its patches.
//
// The host triangulates the boundaries of all patches and settles which of their pieces are split.
// The patches then go to the device in batches, as large as their memory allows. Two threads take
// batches in turn, each with a stream of its own: while the device meshes one batch, another is
// packed, travels, or travels back. The host meshes what is left.
#include <cuda_runtime.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "arrangement/mesher/patch_batch.hpp"
#include "arrangement/mesher/patch_device.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_structures.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh {
namespace {

using mesher::GatheredPatches;
using mesher::GatherPlace;

// The most patches of a batch: as many as fill a device.
constexpr std::size_t kPatchesOfBatch = std::size_t{1} << 15;

// An array of the host that is used for one batch after another, since the first write to a page
// costs more than the others. It need not be page-locked: upload_parts() and download_parts() copy
// through page-locked memory of their own.
template <class T>
class KeptRoom {
 public:
  // An array of at least `count` elements, whose values are undefined.
  T* take(std::size_t count) {
    if (count > size_) {
      room_.reset();
      room_ = std::make_unique_for_overwrite<T[]>(count);
      size_ = count;
    }
    return room_.get();
  }

 private:
  std::unique_ptr<T[]> room_;
  std::size_t size_ = 0;
};

struct HostRoom {
  KeptRoom<std::byte> input;
  KeptRoom<PatchOutcome> outcomes;
  KeptRoom<Vec3d> interior;
  KeptRoom<std::array<std::uint32_t, 3>> triangles;
  KeptRoom<PieceSplit> splits;
};

// Where the results of each patch go, one after another; the last place is the end.
std::vector<GatherPlace> places_of(const PatchOutcome* outcomes, std::size_t count) {
  std::vector<GatherPlace> places(count + 1, GatherPlace{0, 0, 0});
  for (std::size_t i = 0; i < count; ++i) {
    const PatchOutcome& o = outcomes[i];
    const bool failed = o.failure != PatchFailure::none;
    places[i + 1] = {places[i].interior + (failed ? 0 : o.interior),
                     places[i].triangle + (failed ? 0 : o.triangles),
                     places[i].split + (failed ? 0 : o.splits)};
  }
  return places;
}

// Meshes one batch and gives the results to its jobs.
void mesh_batch(std::span<PatchJob> jobs, std::span<const std::uint32_t> which, HostRoom& room,
                const Stream& stream) {
  const PatchBatch batch(jobs, which);
  const auto count = static_cast<std::uint32_t>(batch.patches().size());
  if (count == 0) return;  // PatchBatch leaves out patches with very short edges
  std::byte* const input = room.input.take(batch.input_bytes());
  batch.pack(input);
  const DeviceArray<std::byte> device_input(batch.input_bytes(), stream),
      work(batch.work_bytes(), stream);
  const DeviceArray<BoundedPatch> patches(count, stream);
  const DeviceArray<Vec3d> lattice(batch.lattice().size(), stream);
  const DeviceArray<PatchOutcome> device_outcomes(count, stream);
  upload_parts({{device_input.data(), input, device_input.bytes()},
                {patches.data(), batch.patches().data(), patches.bytes()},
                {lattice.data(), batch.lattice().data(), lattice.bytes()}},
               stream);
  mesher::mesh_patches(patches.data(), count, {device_input.data(), work.data(), lattice.data()},
                       device_outcomes.data(), mesher::patches_per_warp(count), stream);
  PatchOutcome* const outcomes = room.outcomes.take(count);
  download_parts({{outcomes, device_outcomes.data(), device_outcomes.bytes()}}, stream);

  const std::vector<GatherPlace> places = places_of(outcomes, count);
  const DeviceArray<GatherPlace> device_places(places.size(), stream);
  upload_parts({{device_places.data(), places.data(), device_places.bytes()}}, stream);
  const DeviceArray<Vec3d> device_interior(places[count].interior, stream);
  const DeviceArray<std::array<std::uint32_t, 3>> device_triangles(places[count].triangle, stream);
  const DeviceArray<PieceSplit> device_splits(places[count].split, stream);
  mesher::gather_patches(device_outcomes.data(), device_places.data(), count,
                         {device_interior.data(), device_triangles.data(), device_splits.data()},
                         stream);
  Vec3d* const interior = room.interior.take(device_interior.size());
  auto* const triangles = room.triangles.take(device_triangles.size());
  PieceSplit* const splits = room.splits.take(device_splits.size());
  download_parts({{interior, device_interior.data(), device_interior.bytes()},
                  {triangles, device_triangles.data(), device_triangles.bytes()},
                  {splits, device_splits.data(), device_splits.bytes()}},
                 stream);
  tbb::parallel_for(std::size_t{0}, std::size_t{count}, [&](std::size_t i) {
    if (outcomes[i].failure != PatchFailure::none) return;
    PatchJob& job = jobs[batch.job(i)];
    const GatherPlace &from = places[i], &to = places[i + 1];
    *job.mesh = {};
    job.mesh->interior.assign(interior + from.interior, interior + to.interior);
    job.mesh->triangles.assign(triangles + from.triangle, triangles + to.triangle);
    job.mesh->splits.assign(splits + from.split, splits + to.split);
    sort_requests(job.mesh->splits);
    job.is_done = true;
  });
}

// Cuts the jobs that are for a device into batches of at most so many bytes, but of one job at
// least.
std::vector<std::vector<std::uint32_t>> batches_of(std::span<const PatchJob> jobs,
                                                   std::size_t most_bytes) {
  std::vector<std::vector<std::uint32_t>> batches;
  std::size_t bytes = most_bytes;  // of the last batch; "full", so that the first job begins one
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    const PatchSizes sizes = sizes_of(jobs[j]);
    if (!is_for_device(sizes)) continue;
    const std::size_t of_job = work_bytes(sizes);
    if (bytes + of_job > most_bytes || batches.back().size() == kPatchesOfBatch) {
      batches.emplace_back();
      bytes = 0;
    }
    bytes += of_job;
    batches.back().push_back(j);
  }
  return batches;
}

class CudaPatchDevice final : public PatchDevice {
 public:
  // With fewer patches the host is quicker. The number is an estimate.
  std::size_t least_jobs() const override { return 1024; }

  void mesh(std::span<PatchJob> jobs, Monitor* monitor) override {
    const DeviceScope scope;
    int device = 0;
    check_cuda(cudaGetDevice(&device), "device");
    // Each of the two threads may take a quarter of what is free; inputs and results take less than
    // the work memory.
    std::size_t free = 0, total = 0;
    check_cuda(cudaMemGetInfo(&free, &total), "memory");
    const auto batches = batches_of(jobs, free / 4);
    std::atomic<std::size_t> next{0};
    const auto take_batches = [&](std::size_t) {
      check_cuda(cudaSetDevice(device), "device");
      const Stream stream;
      HostRoom room;
      for (std::size_t i = next++; i < batches.size(); i = next++) {
        mesh_batch(jobs, batches[i], room, stream);
        advance(monitor, batches[i].size());
      }
    };
    run_on_threads(std::min<std::size_t>(batches.size(), 2), take_batches);
  }
};

class CudaExactMesher final : public ExactMesher {
 public:
  ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options) const override {
    CudaPatchDevice device;
    return mesh_union_with(&device, spheres, options);
  }
};

}  // namespace

std::unique_ptr<ExactMesher> make_cuda_exact_mesher() {
  return std::make_unique<CudaExactMesher>();
}

}  // namespace vdwmesh
