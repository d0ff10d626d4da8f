// The crease-exact mesher with a CUDA device for its patches.
//
// The host triangulates the boundaries of all patches and settles which of their pieces are split.
// The patches then go to the device in batches, as large as the free memory of the device allows: a
// quarter of it for each. Two threads take batches in turn, each with a stream of its own: while
// the device meshes one batch, another is packed or travels. The host meshes what is left. The
// device keeps its patches until the host has numbered all vertices; then it writes them into the
// mesh, batch by batch, and their part of the mesh travels to the host.
#include <cuda_runtime.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "arrangement/mesher/patch_batch.hpp"
#include "arrangement/mesher/patch_device.hpp"
#include "core/fixed_blocks.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_structures.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh {
namespace {

using mesher::GatherPlace;

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
  KeptRoom<PieceSplit> splits;
};

// The patches of a batch in device memory, one after another, in the order of the batch.
struct KeptBatch {
  std::vector<GatherPlace> places;  // of each patch; the last place is the end
  DeviceArray<Vec3d> interior;
  DeviceArray<std::array<std::uint32_t, 3>> triangles;
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

// Writes to the job what became of its patch. A patch that failed is left to the host.
void report(const PatchOutcome& outcome, const PieceSplit* splits, PatchJob& job) {
  if (outcome.failure != PatchFailure::none) return;
  *job.mesh = {};
  job.mesh->splits.assign(splits, splits + outcome.splits);
  sort_requests(job.mesh->splits);
  job.is_done = true;
  job.is_kept = outcome.triangles > 0;
  job.interior = outcome.interior;
  job.triangles = outcome.triangles;
}

// Meshes one batch and keeps the patches. For each job that is in the batch, its element of
// `place_of_job` is set to its index there.
KeptBatch mesh_batch(std::span<PatchJob> jobs, std::span<const std::uint32_t> which, HostRoom& room,
                     std::span<std::uint32_t> place_of_job, const Stream& stream) {
  const PatchBatch batch(jobs, which);
  const auto count = static_cast<std::uint32_t>(batch.patches().size());
  if (count == 0) return {};  // PatchBatch leaves out patches with very short edges
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
  // Waits for the kernels before the transfer, not within it: a transfer holds the lock on the
  // page-locked buffers, which the other thread may want meanwhile.
  stream.wait();
  PatchOutcome* const outcomes = room.outcomes.take(count);
  download_parts({{outcomes, device_outcomes.data(), device_outcomes.bytes()}}, stream);

  KeptBatch kept{places_of(outcomes, count), {}, {}};
  const GatherPlace& end = kept.places.back();
  const DeviceArray<GatherPlace> device_places(kept.places.size(), stream);
  upload_parts({{device_places.data(), kept.places.data(), device_places.bytes()}}, stream);
  kept.interior = DeviceArray<Vec3d>(end.interior, stream);
  kept.triangles = DeviceArray<std::array<std::uint32_t, 3>>(end.triangle, stream);
  const DeviceArray<PieceSplit> device_splits(end.split, stream);
  mesher::gather_patches(device_outcomes.data(), device_places.data(), count,
                         {kept.interior.data(), kept.triangles.data(), device_splits.data()},
                         stream);
  PieceSplit* const splits = room.splits.take(device_splits.size());
  download_parts({{splits, device_splits.data(), device_splits.bytes()}}, stream);
  // The arrays outlive the stream.
  kept.interior.give_back_on(nullptr);
  kept.triangles.give_back_on(nullptr);
  for_each_index(count, [&](std::size_t i) {
    const std::uint32_t j = batch.job(i);
    place_of_job[j] = static_cast<std::uint32_t>(i);
    report(outcomes[i], splits + kept.places[i].split, jobs[j]);
  });
  return kept;
}

// Consecutive places, without gaps between their vertices or triangles: parts of the mesh that are
// downloaded in one piece.
struct PlaceRun {
  std::uint64_t vertex, vertices, triangle, triangles;
};

std::vector<PlaceRun> runs_of(std::span<const PatchPlace> places, std::span<const PatchJob> jobs) {
  std::vector<PlaceRun> runs;
  for (const PatchPlace& place : places) {
    const PatchJob& job = jobs[place.job];
    if (runs.empty() || runs.back().vertex + runs.back().vertices != place.first_vertex ||
        runs.back().triangle + runs.back().triangles != place.first_triangle) {
      runs.push_back({place.first_vertex, 0, place.first_triangle, 0});
    }
    runs.back().vertices += job.interior;
    runs.back().triangles += job.triangles;
  }
  return runs;
}

// Copies the runs from `part`, where they stand one after another, to their places in the mesh.
void download_runs(const std::vector<PlaceRun>& runs, const DeviceMesh& part, IndexedMesh& mesh,
                   const Stream& stream) {
  std::vector<DownloadPart> parts;
  std::uint64_t vertex = 0, triangle = 0;
  const auto add = [&](auto* to, const auto* from, std::uint64_t count) {
    parts.push_back({to, from, count * sizeof(*to)});
  };
  for (const PlaceRun& run : runs) {
    add(mesh.positions.data() + run.vertex, part.positions.data() + vertex, run.vertices);
    add(mesh.normals.data() + run.vertex, part.normals.data() + vertex, run.vertices);
    add(mesh.vertex_spheres.atoms.data() + run.vertex, part.vertex_spheres.atoms.data() + vertex,
        run.vertices);
    add(mesh.vertex_spheres.others.data() + run.vertex, part.vertex_spheres.others.data() + vertex,
        run.vertices);
    add(mesh.triangles.data() + run.triangle, part.corners.data() + 3 * triangle, run.triangles);
    add(mesh.triangle_spheres.data() + run.triangle, part.triangle_spheres.data() + triangle,
        run.triangles);
    vertex += run.vertices;
    triangle += run.triangles;
  }
  download_parts(parts, stream);
}

// Writes the patches of one batch into the mesh. They are places first, first + 1, ... of `all`.
void place_batch(const KeptBatch& kept, const PatchPlaces& all, std::size_t first,
                 std::size_t count, std::span<const PatchJob> jobs,
                 std::span<const std::uint32_t> place_of_job, IndexedMesh& mesh,
                 const Stream& stream) {
  const std::span<const PatchPlace> places = all.places.subspan(first, count);
  std::vector<mesher::PlacedPatch> patches(count);
  std::uint64_t boundary = 0, vertices = 0, triangles = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const PatchPlace& to = places[i];
    const PatchJob& job = jobs[to.job];
    const GatherPlace& from = kept.places[place_of_job[to.job]];
    patches[i] = {to.sphere,
                  from.interior,
                  from.triangle,
                  vertices,
                  triangles,
                  boundary,
                  static_cast<std::uint32_t>(to.first_vertex),
                  to.boundary_points,
                  job.interior,
                  job.triangles,
                  to.id};
    boundary += to.boundary_points;
    vertices += job.interior;
    triangles += job.triangles;
  }
  Buffer<std::uint32_t> boundary_vertices(boundary);
  for_each_index(count, [&](std::size_t i) {
    all.boundary_vertices(first + i,
                          {boundary_vertices.data() + patches[i].boundary, patches[i].points});
  });
  const DeviceArray<mesher::PlacedPatch> device_patches(count, stream);
  const DeviceArray<std::uint32_t> device_boundary(boundary, stream);
  DeviceMesh part(vertices, triangles, stream, LabelWidth::three, Normals::gradients,
                  Connectivity::triangles);
  part.triangle_spheres = DeviceArray<SphereId>(triangles, stream);
  upload_parts({{device_patches.data(), patches.data(), device_patches.bytes()},
                {device_boundary.data(), boundary_vertices.data(), device_boundary.bytes()}},
               stream);
  mesher::place_patches(device_patches.data(), static_cast<std::uint32_t>(count),
                        {kept.interior.data(), kept.triangles.data(), nullptr},
                        device_boundary.data(), all.unit, part.view(), stream);
  download_runs(runs_of(places, jobs), part, mesh, stream);
}

// Computes on the device that is current where it is made, whatever thread calls it.
class CudaPatchDevice final : public PatchDevice {
 public:
  CudaPatchDevice() {
    const DeviceScope scope;
    check_cuda(cudaGetDevice(&device_), "device");
  }
  ~CudaPatchDevice() override {
    if (kept_.empty()) return;
    const QuietDeviceScope scope(device_);
    kept_.clear();
  }

  void mesh(std::span<PatchJob> jobs, Monitor* monitor) override {
    const DeviceScope scope(device_);
    kept_.clear();
    jobs_ = jobs;
    place_of_job_.assign(jobs.size(), 0);
    std::size_t free = 0, total = 0;
    check_cuda(cudaMemGetInfo(&free, &total), "memory");
    batches_ = batches_of(jobs, free);
    kept_.resize(batches_.size());
    for_each_batch([&](std::size_t i, HostRoom& room, const Stream& stream) {
      kept_[i] = mesh_batch(jobs, batches_[i], room, place_of_job_, stream);
      advance(monitor, batches_[i].size());
    });
  }

  void place(const PatchPlaces& all, IndexedMesh& mesh) override {
    const DeviceScope scope(device_);
    for_each_batch([&](std::size_t i, HostRoom&, const Stream& stream) {
      if (batches_[i].empty()) return;
      // Places ascend by job and are of kept patches only, and the batches are disjoint ranges of
      // jobs. So all places from the first to the last job of a batch are of this batch.
      const auto begin = std::ranges::lower_bound(all.places, batches_[i].front(), {},
                                                  &PatchPlace::job),
                 end =
                     std::ranges::upper_bound(all.places, batches_[i].back(), {}, &PatchPlace::job);
      if (begin == end) return;
      place_batch(kept_[i], all, static_cast<std::size_t>(begin - all.places.begin()),
                  static_cast<std::size_t>(end - begin), jobs_, place_of_job_, mesh, stream);
    });
    kept_.clear();
  }

 private:
  // Calls work(i, room, stream) for every batch, on two threads.
  template <class Work>
  void for_each_batch(const Work& work) const {
    std::atomic<std::size_t> next{0};
    run_on_threads(std::min<std::size_t>(batches_.size(), 2), [&](std::size_t) {
      check_cuda(cudaSetDevice(device_), "device");
      const Stream stream;
      HostRoom room;
      for (std::size_t i = next++; i < batches_.size(); i = next++) work(i, room, stream);
    });
  }

  int device_ = 0;
  std::span<PatchJob> jobs_;  // of the last call of mesh()
  std::vector<std::vector<std::uint32_t>> batches_;
  std::vector<KeptBatch> kept_;              // by batch
  std::vector<std::uint32_t> place_of_job_;  // in its batch
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
