// The crease-exact mesher with a CUDA device for its patches.
//
// If there are many boundaries, the device looks at them first (boundary_looks.cuh). The host
// settles which of their pieces are split. Patches whose boundaries have come to rest go to the
// device in batches, as large as the free memory of the device allows: a quarter of it for each.
// Two threads take batches in turn, each with a stream of its own: while the device meshes one
// batch, another is packed or travels. The host meshes what is left. The device keeps its patches
// until the host has numbered all vertices; then it writes them into the mesh, part by part. A part
// is a run of vertices and triangles, which travels to the host in one piece for each array. Once
// half of the memory is full of kept patches, the following batches travel to the host at once,
// which writes their patches as its own: so the mesh need not fit the device.
#include <cuda_runtime.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
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
#include "cuda/mesher/batch_rooms.cuh"
#include "cuda/mesher/boundary_looks.cuh"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh {
namespace {

using mesher::GatherPlace;
using mesher::KeptRoom;

// `batch` is empty, or packed, with its arrays in `input` and `sources`.
struct HostRoom {
  std::optional<PatchBatch> batch;
  KeptRoom<std::byte> input;
  KeptRoom<PointSource> sources;
  KeptRoom<PatchOutcome> outcomes;
  KeptRoom<PieceSplit> splits;
  // For a batch that the device does not keep.
  KeptRoom<Vec3d> interior;
  KeptRoom<std::array<std::uint32_t, 3>> triangles;
};

// The patches of a batch in device memory, one after another, in the order of the batch.
struct KeptBatch {
  std::vector<GatherPlace> places;           // of each patch; the last place is the end
  std::vector<std::uint64_t> first_sources;  // as in PatchBatch
  DeviceArray<Vec3d> interior;
  DeviceArray<std::array<std::uint32_t, 3>> triangles;
  DeviceArray<PointSource> sources;

  std::uint64_t bytes() const { return interior.bytes() + triangles.bytes() + sources.bytes(); }
};

// PatchJob::kept: patch `place` of batch `batch`.
struct KeptName {
  std::uint32_t batch, place;
  std::uint64_t packed() const { return std::uint64_t{batch} << 32 | place; }
  static KeptName of(std::uint64_t packed) {
    return {static_cast<std::uint32_t>(packed >> 32), static_cast<std::uint32_t>(packed)};
  }
};

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
    const GatherPlace &begin = batch.places[i], &end = batch.places[i + 1];
    assign(interior, begin.interior, end.interior, job.patch->interior);
    assign(triangles, begin.triangle, end.triangle, job.patch->triangles);
    assign<PointSource>(room.sources.data(), batch.first_sources[i], batch.first_sources[i + 1],
                        job.patch->sources);
  });
}

// The arrays outlive the stream.
void outlive_stream(KeptBatch& kept) {
  kept.interior.give_back_on(nullptr);
  kept.triangles.give_back_on(nullptr);
  kept.sources.give_back_on(nullptr);
}

// To be called from PatchOrder::look().
void pack_batch(const PatchOrder& order, std::span<const std::uint32_t> which, HostRoom& room) {
  const PatchBatch& batch = room.batch.emplace(order.jobs, which);
  for (const std::uint32_t j : which) order.jobs[j].is_begun = true;
  batch.pack(room.input.take(batch.input_bytes()));
  batch.pack_sources(order.sources, room.sources.take(batch.first_sources().back()));
}

// Meshes the batch in `room`, which has this number. Returns the patches that the device keeps, all
// or none: `may_keep` says whether it may keep so many bytes.
template <class MayKeep>
KeptBatch mesh_batch(const PatchOrder& order, std::uint32_t number, HostRoom& room,
                     const MayKeep& may_keep, const Stream& stream) {
  const PatchBatch batch = std::move(*room.batch);
  room.batch.reset();
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
  mesher::mesh_patches(patches.data(), count, {device_input.data(), work.data(), lattice.data()},
                       device_outcomes.data(), mesher::patches_per_warp(count), stream);
  // Waits for the kernels before the transfer, not within it: a transfer holds the lock on the
  // page-locked buffers, which the other thread may want meanwhile.
  stream.wait();
  PatchOutcome* const outcomes = room.outcomes.take(count);
  download_parts({{outcomes, device_outcomes.data(), device_outcomes.bytes()}}, stream);

  kept.places = mesher::places_of(outcomes, count);
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
  for_each_index(count, [&](std::size_t i) {
    report(outcomes[i], splits + kept.places[i].split, {number, static_cast<std::uint32_t>(i)},
           order.jobs[batch.job(i)]);
  });
  if (!may_keep(kept.bytes())) {
    return_batch(kept, batch, room, order.jobs, stream);
    return {};
  }
  outlive_stream(kept);
  return kept;
}

// Of an interior point and of a triangle in a mesh: what download_part() copies.
constexpr std::uint64_t kVertexBytes = sizeof(Vec3d) + sizeof(Vec3f) + 3 * sizeof(SphereId),
                        kTriangleBytes = sizeof(Triangle) + sizeof(SphereId);

// A run of places, and how many vertices and triangles there are from the first to the last one,
// those of other patches between them included.
struct MeshPart {
  std::span<const PatchPlace> places;
  std::uint64_t vertices, triangles;

  explicit MeshPart(std::span<const PatchPlace> some)
      : places(some),
        vertices(some.back().first_vertex + some.back().interior - some.front().first_vertex),
        triangles(some.back().first_triangle + some.back().triangles -
                  some.front().first_triangle) {}

  std::uint64_t device_bytes() const {
    return vertices * kVertexBytes + triangles * kTriangleBytes +
           places.size() * sizeof(mesher::PlacedPatch);
  }
};

// Parts of about this many bytes on the device, some four million triangles, so that parts travel
// while others are written, and all pieces are long.
constexpr std::uint64_t kMostPartBytes = std::uint64_t{160} << 20;

// Parts of up to so many bytes, but of one place at least.
std::vector<MeshPart> parts_of(std::span<const PatchPlace> places, std::uint64_t most_bytes) {
  std::vector<MeshPart> parts;
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    do ++end;
    while (end < places.size() &&
           MeshPart(places.subspan(begin, end + 1 - begin)).device_bytes() <= most_bytes);
    parts.emplace_back(places.subspan(begin, end - begin));
  }
  return parts;
}

// Copies a part to its place in the mesh.
void download_part(const MeshPart& part, const DeviceMesh& from, IndexedMesh& mesh,
                   const Stream& stream) {
  std::vector<DownloadPart> parts;
  const auto add = [&](auto* to, const auto* first, std::uint64_t count) {
    parts.push_back({to, first, count * sizeof(*to)});
  };
  const std::uint64_t vertex = part.places.front().first_vertex,
                      triangle = part.places.front().first_triangle;
  add(mesh.positions.data() + vertex, from.positions.data(), part.vertices);
  add(mesh.normals.data() + vertex, from.normals.data(), part.vertices);
  add(mesh.vertex_spheres.atoms.data() + vertex, from.vertex_spheres.atoms.data(), part.vertices);
  add(mesh.vertex_spheres.others.data() + vertex, from.vertex_spheres.others.data(), part.vertices);
  add(mesh.triangles.data() + triangle, from.corners.data(), part.triangles);
  add(mesh.triangle_spheres.data() + triangle, from.triangle_spheres.data(), part.triangles);
  download_parts(parts, stream);
}

mesher::PlacedPatch placed(const PatchPlace& place, const MeshPart& part,
                           const std::vector<KeptBatch>& batches) {
  const KeptName name = KeptName::of(place.kept);
  const KeptBatch& batch = batches[name.batch];
  const GatherPlace& from = batch.places[name.place];
  const std::uint64_t source = batch.first_sources[name.place];
  return {place.sphere,
          batch.interior.data() + from.interior,
          batch.triangles.data() + from.triangle,
          batch.sources.data() + source,
          place.first_vertex - part.places.front().first_vertex,
          place.first_triangle - part.places.front().first_triangle,
          static_cast<std::uint32_t>(place.first_vertex),
          static_cast<std::uint32_t>(batch.first_sources[name.place + 1] - source),
          place.interior,
          3 * place.triangles,
          place.id};
}

// Writes one part of the mesh. What lies between the places becomes zeros.
void write_part(const MeshPart& part, const std::vector<KeptBatch>& batches,
                const std::uint32_t* first_vertices, double unit, IndexedMesh& mesh,
                const Stream& stream) {
  const std::size_t count = part.places.size();
  Buffer<mesher::PlacedPatch> patches(count);
  for_each_index(count, [&](std::size_t i) { patches[i] = placed(part.places[i], part, batches); });
  const DeviceArray<mesher::PlacedPatch> device_patches(count, stream);
  DeviceMesh written(part.vertices, part.triangles, stream, LabelWidth::three, Normals::gradients,
                     Connectivity::triangles);
  written.triangle_spheres = DeviceArray<SphereId>(part.triangles, stream);
  clear(written.positions, stream);
  clear(written.normals, stream);
  clear(written.vertex_spheres.atoms, stream);
  clear(written.vertex_spheres.others, stream);
  clear(written.corners, stream);
  clear(written.triangle_spheres, stream);
  upload_parts({{device_patches.data(), patches.data(), device_patches.bytes()}}, stream);
  mesher::place_patches(device_patches.data(), static_cast<std::uint32_t>(count), first_vertices,
                        unit, written.view(), stream);
  // Before the transfer, not within it, as in mesh_batch().
  stream.wait();
  download_part(part, written, mesh, stream);
}

// Computes on the device that is current where it is made, whatever thread calls it.
class CudaPatchDevice final : public PatchDevice {
 public:
  // With up to so many bytes of the device's memory.
  explicit CudaPatchDevice(std::uint64_t most_bytes) : most_bytes_(most_bytes) {
    const DeviceScope scope;
    check_cuda(cudaGetDevice(&device_), "device");
  }
  ~CudaPatchDevice() override {
    if (kept_.empty()) return;
    const QuietDeviceScope scope(device_);
    kept_.clear();
  }

  void look(const LookOrder& order) override {
    const DeviceScope scope(device_);
    mesher::look_at_boundaries(order, memory());
  }

  void mesh(const PatchOrder& order) override {
    const DeviceScope scope(device_);
    const DeviceShares shares(memory());
    std::vector<std::vector<std::uint32_t>> batches;
    // The first batches of both threads are packed at once, so that the host has to wait for its
    // next round only once, and the device does not wait for it.
    for (HostRoom& room : rooms_) room.batch.reset();  // whatever a call that failed has left
    look_first(order, [&] {
      batches = batches_of(order.jobs, shares.batch);
      for (std::size_t i = 0; i < std::min(batches.size(), rooms_.size()); ++i) {
        pack_batch(order, batches[i], rooms_[i]);
      }
    });
    const std::size_t before = kept_.size();
    kept_.resize(before + batches.size());
    // Of two batches that end at the same time, one after the other takes its part.
    const auto may_keep = [&](std::uint64_t bytes) {
      const std::uint64_t with = kept_bytes_ += bytes;
      if (with <= shares.kept) return true;
      kept_bytes_ -= bytes;
      return false;
    };
    for_each(batches.size(), [&](std::size_t i, HostRoom& room, const Stream& stream) {
      if (!room.batch) look_first(order, [&] { pack_batch(order, batches[i], room); });
      kept_[before + i] =
          mesh_batch(order, static_cast<std::uint32_t>(before + i), room, may_keep, stream);
      advance(order.monitor, batches[i].size());
    });
  }

  std::uint64_t batches() const override { return kept_.size(); }

  void place(const PatchPlaces& all, IndexedMesh& mesh) override {
    if (all.places.empty()) return;
    const DeviceScope scope(device_);
    const Stream stream;
    const std::uint64_t memory_of_parts = memory() - kept_bytes_;
    const DeviceArray<std::uint32_t> first_vertices(all.first_vertices.size(), stream);
    upload_parts({{first_vertices.data(), all.first_vertices.data(), first_vertices.bytes()}},
                 stream);
    const std::uint64_t left =
        memory_of_parts - std::min<std::uint64_t>(memory_of_parts, first_vertices.bytes());
    const std::vector<MeshPart> parts =
        parts_of(all.places, std::min(kMostPartBytes, left / rooms_.size()));
    for_each(parts.size(), [&](std::size_t i, HostRoom&, const Stream& own) {
      write_part(parts[i], kept_, first_vertices.data(), all.unit, mesh, own);
    });
  }

  void forget() override {
    const DeviceScope scope(device_);
    kept_.clear();
    kept_bytes_ = 0;
  }

 private:
  // The bytes of the device that this object may have, with what it keeps already. An eighth of
  // what is free is left, since memory comes in larger pieces than those asked for.
  std::uint64_t memory() const {
    return std::min(most_bytes_, available_device_memory() / 8 * 7 + kept_bytes_);
  }

  // Calls look(), for whose work the host's cores leave what else they have: until it is done, the
  // device waits, and so may the host's next round.
  template <class Look>
  void look_first(const PatchOrder& order, const Look& look) {
    order.look([&] { packing_.execute(look); });
  }

  // Calls work(i, room, stream) for i = 0 .. count - 1, on two threads. Thread i begins with i.
  template <class Work>
  void for_each(std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{rooms_.size()};
    run_on_threads(std::min(count, rooms_.size()), [&](std::size_t thread) {
      check_cuda(cudaSetDevice(device_), "device");
      const Stream stream;
      for (std::size_t i = thread; i < count; i = next++) work(i, rooms_[thread], stream);
    });
  }

  std::uint64_t most_bytes_;
  int device_ = 0;
  std::array<HostRoom, 2> rooms_;  // for the two threads
  tbb::task_arena packing_{tbb::task_arena::automatic, 1, tbb::task_arena::priority::high};
  std::vector<KeptBatch> kept_;  // empty for batches that went to the host
  std::atomic<std::uint64_t> kept_bytes_ = 0;
};

class CudaExactMesher final : public ExactMesher {
 public:
  ExactMesh mesh(const SphereSet& spheres, const ExactMeshOptions& options) const override {
    CudaPatchDevice device(options.device_memory);
    return mesh_union_with(&device, spheres, options);
  }
};

}  // namespace

std::unique_ptr<ExactMesher> make_cuda_exact_mesher() {
  return std::make_unique<CudaExactMesher>();
}

}  // namespace vdwmesh
