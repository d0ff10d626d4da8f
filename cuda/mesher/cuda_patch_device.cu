// What a thread that feeds the device does with a batch, and how the patches that the device keeps
// get into the mesh. cuda_patch_device.cuh says how the device is used.
#include <cuda_runtime.h>

#include <algorithm>
#include <memory>
#include <span>

#include "core/fixed_blocks.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/memory/waits.cuh"
#include "cuda/mesher/boundary_looks.cuh"
#include "cuda/mesher/cuda_patch_device.cuh"
#include "cuda/mesher/mesh_parts.cuh"
#include "measures/many_unions.hpp"

namespace vdwmesh::mesher {
namespace {

// Writes to the job what became of its patch, and that the device keeps it under this name. A patch
// that failed is left to the host.
void report(const PatchOutcome& outcome, const PieceSplit* splits, KeptName name, PatchJob& job) {
  if (outcome.failure != PatchFailure::none) return;
  if (outcome.splits > 0) {
    job.patch = std::make_unique<PatchMesh>();
    job.patch->splits.assign(splits, splits + outcome.splits);
    sort_requests(job.patch->splits);
  }
  job.is_done = true;
  job.is_kept = outcome.triangles > 0;
  job.interior = outcome.interior;
  job.triangles = outcome.triangles;
  job.kept = name.packed();
}

template <class T>
void assign(const T* from, std::uint64_t begin, std::uint64_t end, PatchVector<T>& to) {
  to.assign(from + begin, from + end);
}

// Brings a batch, which was meshed in this room, to the host, and gives its patches to their jobs.
void return_batch(const KeptBatch& batch, const PatchBatch& packed, HostRoom& room,
                  std::span<PatchJob> jobs, const Stream& stream) {
  const Vec3d* const interior = room.interior.take(batch.interior.size());
  const std::array<std::uint32_t, 3>* const triangles = room.triangles.take(batch.triangles.size());
  download_parts({{room.interior.data(), batch.interior.data(), batch.interior.bytes()},
                  {room.triangles.data(), batch.triangles.data(), batch.triangles.bytes()}},
                 stream);
  for_each_index(packed.patches().size(), [&](std::size_t i) {
    PatchJob& job = jobs[packed.job(i)];
    if (!job.is_kept) return;
    job.is_kept = false;
    job.patch = std::make_unique<PatchMesh>();
    const ResultOffsets &begin = batch.offsets[i], &end = batch.offsets[i + 1];
    assign(interior, begin.interior, end.interior, job.patch->interior);
    assign(triangles, begin.triangle, end.triangle, job.patch->triangles);
    assign<PointSource>(room.sources.data(), batch.first_sources[i], batch.first_sources[i + 1],
                        job.patch->sources);
  });
}

// Packs these jobs into `input` and `sources` of the room. To be called from PatchOrder::look().
PatchBatch pack_batch(const PatchOrder& order, std::span<const std::uint32_t> which,
                      HostRoom& room) {
  PatchBatch batch(order.jobs, which);
  for (const std::uint32_t j : which) order.jobs[j].is_begun = true;
  batch.pack(room.input.take(batch.input_bytes()));
  batch.pack_sources(order.sources, room.sources.take(batch.first_sources().back()));
  return batch;
}

// Meshes the batch packed in `room`, which has this number. Returns the patches that the device
// keeps, all or none: `may_keep` says whether it may keep so many bytes.
template <class MayKeep>
KeptBatch mesh_batch(const PatchOrder& order, const PatchBatch& batch, std::uint32_t number,
                     HostRoom& room, const MayKeep& may_keep, const Stream& stream) {
  const auto count = static_cast<std::uint32_t>(batch.patches().size());
  // Patches with very short edges are left out, and those withdrawn.
  if (count == 0) return {};
  KeptBatch kept;
  kept.first_sources = batch.first_sources();
  kept.sources = DeviceArray<PointSource>(kept.first_sources.back(), stream);
  const DeviceArray<std::byte> device_input(batch.input_bytes(), stream),
      work(batch.work_bytes(), stream);
  const DeviceArray<BoundedPatch> patches(count, stream);
  const DeviceArray<Vec3d> lattice(batch.lattice().size(), stream);
  const DeviceArray<PatchOutcome> device_outcomes(count, stream);
  upload_parts({{device_input.data(), room.input.data(), device_input.bytes()},
                {kept.sources.data(), room.sources.data(), kept.sources.bytes()},
                {patches.data(), batch.patches().data(), patches.bytes()},
                {lattice.data(), batch.lattice().data(), lattice.bytes()}},
               stream);
  mesh_patches(patches.data(), count, {device_input.data(), work.data(), lattice.data()},
               device_outcomes.data(), patches_per_warp(count), stream);
  // Waits for the kernels before the transfer, not within it: a transfer holds the lock on the
  // page-locked buffers, which the other thread may want meanwhile.
  wait_asleep(stream);
  PatchOutcome* const outcomes = room.outcomes.take(count);
  download_parts({{outcomes, device_outcomes.data(), device_outcomes.bytes()}}, stream);

  kept.offsets = offsets_of(outcomes, count);
  const ResultOffsets& end = kept.offsets.back();
  const DeviceArray<ResultOffsets> device_offsets(kept.offsets.size(), stream);
  upload_parts({{device_offsets.data(), kept.offsets.data(), device_offsets.bytes()}}, stream);
  kept.interior = DeviceArray<Vec3d>(end.interior, stream);
  kept.triangles = DeviceArray<std::array<std::uint32_t, 3>>(end.triangle, stream);
  const DeviceArray<PieceSplit> device_splits(end.split, stream);
  gather_patches(device_outcomes.data(), device_offsets.data(), count,
                 {kept.interior.data(), kept.triangles.data(), device_splits.data()}, stream);
  PieceSplit* const splits = room.splits.take(device_splits.size());
  download_parts({{splits, device_splits.data(), device_splits.bytes()}}, stream);
  for_each_index(count, [&](std::size_t i) {
    report(outcomes[i], splits + kept.offsets[i].split, {number, static_cast<std::uint32_t>(i)},
           order.jobs[batch.job(i)]);
  });
  if (!may_keep(kept.bytes())) {
    return_batch(kept, batch, room, order.jobs, stream);
    return {};
  }
  kept.outlive_stream();
  return kept;
}

}  // namespace

CudaPatchDevice::CudaPatchDevice(std::uint64_t most_bytes, bool keeps_mesh)
    : most_bytes_(most_bytes), keeps_mesh_(keeps_mesh) {
  const DeviceScope scope;
  check_cuda(cudaGetDevice(&device_), "device");
}

CudaPatchDevice::~CudaPatchDevice() {
  if (kept_.empty() && !assembled_) return;
  const QuietDeviceScope scope(device_);
  kept_.clear();
  assembled_.reset();
}

// The bytes of the device that this object may have, with what it keeps already. An eighth of
// what is free is left, since memory comes in larger pieces than those asked for.
std::uint64_t CudaPatchDevice::memory() const {
  return std::min(most_bytes_, available_device_memory() / 8 * 7 + kept_bytes_);
}

// What kept patches may have is the same until forget(): the first to ask has the device for
// itself. Batches get less if others have taken memory since.
DeviceShares CudaPatchDevice::shares() {
  const std::lock_guard lock(mutex_);
  const DeviceShares now(memory());
  if (!shares_) shares_.emplace(now);
  DeviceShares least = *shares_;
  least.batch = std::min(least.batch, now.batch);
  return least;
}

HostRoom& CudaPatchDevice::take_room() {
  const std::lock_guard lock(mutex_);
  HostRoom& room = *std::ranges::find(rooms_, false, &HostRoom::is_taken);
  room.is_taken = true;
  return room;
}

// Calls work(i, stream) for i = 0 .. count - 1, on two threads. Thread i begins with i.
template <class Work>
void CudaPatchDevice::for_each(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next{threads()};
  run_on_threads(std::min(count, threads()), [&](std::size_t thread) {
    check_cuda(cudaSetDevice(device_), "device");
    const Stream stream;
    const WaitAtEnd wait(stream);
    for (std::size_t i = thread; i < count; i = next++) work(i, stream);
  });
}

void CudaPatchDevice::look(const LookOrder& order) {
  const DeviceScope scope(device_);
  look_at_boundaries(order, memory());
}

void CudaPatchDevice::mesh(const PatchOrder& order) {
  const DeviceScope scope(device_);
  const Stream stream;
  const DeviceShares most = shares();
  // Of two batches that end at the same time, one after the other takes its part.
  const auto may_keep = [&](std::uint64_t bytes) {
    const std::uint64_t with = kept_bytes_ += bytes;
    if (with <= most.kept) return true;
    kept_bytes_ -= bytes;
    return false;
  };
  HostRoom& room = take_room();
  FirstError error;
  error.guard([&] {
    std::vector<std::vector<std::uint32_t>> batches;
    std::optional<PatchBatch> packed;
    // For this work the host's cores leave what else they have: until it is done, the device waits,
    // and so may the host's next round.
    const auto look = [&](const auto& work) { order.look([&] { packing_.execute(work); }); };
    look([&] {
      batches = batches_of(order.jobs, most.batch);
      if (!batches.empty()) packed = pack_batch(order, batches.front(), room);
    });
    for (const std::vector<std::uint32_t>& which : batches) {
      if (!packed) look([&] { packed = pack_batch(order, which, room); });
      std::uint32_t number = 0;
      KeptBatch* kept = nullptr;
      {
        const std::lock_guard lock(mutex_);
        number = static_cast<std::uint32_t>(kept_.size());
        kept = &kept_.emplace_back();
      }
      *kept = mesh_batch(order, *packed, number, room, may_keep, stream);
      packed.reset();
      advance(order.monitor, which.size());
    }
  });
  {
    const std::lock_guard lock(mutex_);
    room.is_taken = false;
  }
  error.rethrow();
}

void CudaPatchDevice::place(const PatchPlaces& all, IndexedMesh& mesh) {
  if (all.places.empty()) return;
  const DeviceScope scope(device_);
  const Stream stream;
  const std::uint64_t memory_of_parts = memory() - kept_bytes_;
  const DeviceArray<std::uint32_t> first_vertices(all.first_vertices.size(), stream);
  upload_parts({{first_vertices.data(), all.first_vertices.data(), first_vertices.bytes()}},
               stream);
  const std::uint64_t left =
      memory_of_parts - std::min<std::uint64_t>(memory_of_parts, first_vertices.bytes());
  const std::vector<MeshSection> sections =
      sections_of(all.places, std::min(kMostSectionBytes, left / threads()));
  for_each(sections.size(), [&](std::size_t i, const Stream& own) {
    write_section(sections[i], kept_, first_vertices.data(), all.unit, mesh, own);
  });
}

void CudaPatchDevice::assemble(const MeshToAssemble& parts) {
  const DeviceScope scope(device_);
  const std::uint64_t all = memory(), kept = kept_bytes_;
  require_device_memory(assembly_bytes(parts), "the mesh", all - std::min(all, kept));
  const Stream stream;
  const WaitAtEnd wait(stream);
  assembled_.emplace(assemble_mesh(parts, kept_, stream));
  assembled_->give_back_on(nullptr);
}

void CudaPatchDevice::forget() {
  const DeviceScope scope(device_);
  kept_.clear();
  kept_bytes_ = 0;
  shares_.reset();
}

}  // namespace vdwmesh::mesher
