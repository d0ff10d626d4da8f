// The Extractor and the FieldMesher on CUDA: what happens on the host around DeviceBrickMesher
// (brick_mesher.cuh), which counts and emits bricks on one device. This file chooses devices,
// uploads spheres or fields, and allocates the mesh's arrays on the host. begin_stage() and
// advance() report progress to the caller's monitor, and advance() throws if the run is cancelled.
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "cuda/count_part.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/extract/bricks/brick_mesher.cuh"
#include "cuda/extract/field_source.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/run_on_threads.hpp"
#include "cuda/memory/transfer.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

MeshArrays arrays_of(const ExtractOptions& options, LabelWidth width) {
  return {.connectivity = options.connectivity, .normals = options.normals, .width = width};
}

// Checks the size against the limits, calls the observer `on_size`, and gives the mesh its arrays
// on the host. Throws LimitExceeded.
void make_checked_room(const MeshSize& size, LabelWidth width, double spacing,
                       const ExtractOptions& options, IndexedMesh& mesh) {
  const MeshArrays arrays = arrays_of(options, width);
  check_mesh_limits({size, arrays, 0, spacing}, options.memory_limit);
  if (options.on_size) options.on_size(size);
  make_room(mesh, size, arrays);
}

constexpr unsigned kThreads = 256;

// use_ids() of spheres/list_ids.hpp. A thread for each list place.
__global__ void use_ids_on_device(CellListView list, const SphereId* ids, SphereId* made) {
  const std::uint32_t place = blockIdx.x * blockDim.x + threadIdx.x;
  if (place < list.size) made[place] = ids[list.id[ListPlace{place}]];
}

// Extracts a surface on one device: uploads the spheres, counts the bricks of a range, and emits a
// share of them. Different threads may call its functions, one after the other. CUDA keeps a
// current device for each thread, so each function first makes the worker's device current.
class SphereWorker {
 public:
  // `sharers` is the number of workers on this device; they share its memory. `ids` are what labels
  // call the spheres; if there are none, their indices. The other arguments must outlive the
  // worker; ids need not once it has counted.
  SphereWorker(int device, std::size_t sharers, const ListToUpload& list,
               std::span<const SphereId> ids, const FieldModel& model,
               const ExtractOptions& options)
      : device_(device),
        sharers_(sharers),
        list_(list),
        ids_(ids),
        model_(model),
        options_(options) {}

  // Counts the bricks of a range; KeyRange{} is the whole surface.
  void count(const KeyRange& own) {
    use_device(device_);
    stream_.emplace();
    device_list_.emplace(upload_list(list_, model_, *stream_));
    source_.emplace(list_with_ids(), model_, *stream_);
    mesher_.emplace(*source_, options_, sharers_);
    mesher_->count(own);
  }

  MeshSize size() const { return mesher_->size(); }
  HaloVertices halo() const { return mesher_->halo(); }

  // Emits share k of `shares` of the range to its place in `mesh`. `first`: see
  // SurfacePart::emit().
  void emit(const MeshSize& first, IndexedMesh& mesh, std::uint64_t k, std::uint64_t shares) {
    use_device(device_);
    mesher_->emit_to_host(first, mesh, k, shares);
  }

  ExtractStats stats() const { return mesher_->stats(); }

 private:
  CellListView list_with_ids() {
    CellListView list = device_list_->view();
    if (ids_.empty()) return list;
    const DeviceArray<SphereId> ids(ids_.size(), stream_->get());
    upload_parts({{ids.data(), ids_.data(), ids.bytes()}}, *stream_);
    list_ids_ = DeviceArray<SphereId>(list.size, stream_->get());
    launch("use_ids", use_ids_on_device, over(list.size, kThreads), *stream_, list, ids.data(),
           list_ids_.data());
    list.id = list_ids_.data();
    return list;
  }

  int device_;
  std::size_t sharers_;
  const ListToUpload& list_;
  std::span<const SphereId> ids_;
  const FieldModel& model_;
  const ExtractOptions& options_;
  std::optional<Stream> stream_;
  std::optional<DeviceCellList> device_list_;
  DeviceArray<SphereId> list_ids_;  // by list place, if ids were given
  std::optional<SphereSource> source_;
  std::optional<DeviceBrickMesher> mesher_;
};

// The usable devices, the current one first.
std::vector<int> devices_from_current() {
  int current = 0;
  check_cuda(cudaGetDevice(&current), "device");
  std::vector<int> devices = usable_devices();
  std::ranges::rotate(devices, std::ranges::find(devices, current));
  return devices;
}

// The statistics of workers that ran side by side. All have counted the same bricks, so counts of
// bricks are taken from the first. Each has emitted a share, so counts of emission are added. Of
// the times the longest counts.
ExtractStats joined_stats(const std::vector<std::unique_ptr<SphereWorker>>& workers) {
  ExtractStats joined = workers[0]->stats();
  for (std::size_t k = 1; k < workers.size(); ++k) {
    const ExtractStats stats = workers[k]->stats();
    joined.clamped_vertices += stats.clamped_vertices;
    joined.slabs += stats.slabs;
    joined.field_seconds = std::max(joined.field_seconds, stats.field_seconds);
    joined.extract_seconds = std::max(joined.extract_seconds, stats.extract_seconds);
    joined.download_seconds = std::max(joined.download_seconds, stats.download_seconds);
  }
  return joined;
}

// The range of bricks that one process extracts, on its current device if that is usable.
class CudaSurfacePart final : public SurfacePart {
 public:
  CudaSurfacePart(const SphereSet& spheres, std::span<const SphereId> ids, const KeyRange& range,
                  const ExtractOptions& options)
      : options_(options),
        workspace_(options.workspace),
        model_(make_field_model(options.field, make_grid(spheres, options.grid))),
        list_(prepare_list(spheres, model_, options.frame, workspace_)) {
    const DeviceScope scope;
    // The only worker on the device.
    worker_.emplace(devices_from_current()[0], 1, list_, ids, model_, options_);
    begin_stage(options_.monitor, "field", 1);
    worker_->count(range);
    advance(options_.monitor, 1);
  }

  MeshSize size() const override { return worker_->size(); }
  HaloVertices halo() const override { return worker_->halo(); }

  ExtractStats emit(const MeshSize& first, IndexedMesh& mesh) override {
    const DeviceScope scope;
    begin_stage(options_.monitor, "extract", 1);
    make_room(mesh, size(), arrays_of(options_, LabelWidth::one));
    worker_->emit(first, mesh, 0, 1);
    advance(options_.monitor, 1);
    return worker_->stats();
  }

 private:
  ExtractOptions options_;
  WorkspaceOfCall workspace_;
  FieldModel model_;
  ListToUpload list_;  // its spheres are used by the constructor only
  std::optional<SphereWorker> worker_;
};

class CudaExtractor final : public Extractor {
 public:
  // Every device searches and counts all bricks, so that it knows the numbers of all vertices and
  // triangles. Each emits only the bricks of its share, slab by slab (runs of bricks that fit the
  // device), directly to their places in the host's arrays.
  void extract_into(ExtractResult& result, const SphereSet& spheres,
                    const ExtractOptions& options) const override {
    if (options.devices < 1) throw InvalidInput("the number of devices must be at least 1");
    WorkspaceOfCall workspace(options.workspace);
    result.grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, result.grid);
    const ListToUpload list = prepare_list(spheres, model, options.frame, workspace);
    const DeviceScope scope;
    const std::vector<int> present = devices_from_current();
    // One worker per share. If fewer devices are present than asked for, some have several workers.
    const auto shares = static_cast<std::size_t>(options.devices);
    const std::size_t sharers = (shares + present.size() - 1) / present.size();
    std::vector<std::unique_ptr<SphereWorker>> workers;
    for (std::size_t k = 0; k < shares; ++k) {
      workers.push_back(std::make_unique<SphereWorker>(
          present[k % present.size()], sharers, list, std::span<const SphereId>(), model, options));
    }
    begin_stage(options.monitor, "field", 1);
    run_on_threads(shares, [&](std::size_t k) { workers[k]->count({}); });
    advance(options.monitor, 1);
    begin_stage(options.monitor, "extract", 1);
    make_checked_room(workers[0]->size(), LabelWidth::one, result.grid.spacing, options,
                      result.mesh);
    run_on_threads(shares, [&](std::size_t k) { workers[k]->emit({}, result.mesh, k, shares); });
    advance(options.monitor, 1);
    result.stats = joined_stats(workers);
  }

  std::unique_ptr<SurfacePart> count(const SphereSet& spheres, const KeyRange& range,
                                     const ExtractOptions& options) const override {
    return count_part_on_cuda(spheres, {}, range, options);
  }
};

class CudaFieldMesher final : public FieldMesher {
 public:
  void mesh_into(ExtractResult& result, const SampledFieldView& field,
                 const ExtractOptions& options) const override {
    check_sampled(field);
    const DeviceScope scope;
    const std::uint64_t nodes = field.grid.node_count();
    require_device_memory(nodes * sizeof(float), "the field", options.device_memory);
    const Stream stream;
    const DeviceArray<float> values = upload(field.values, nodes, stream.get());
    // The mesher may take what the field leaves of the memory allowed.
    ExtractOptions beside_field = options;
    beside_field.device_memory -= values.bytes();
    begin_stage(options.monitor, "field", 1);
    const FieldSource source({field.grid, values.data(), field.isovalue}, beside_field, stream);
    DeviceBrickMesher mesher(source, beside_field);
    mesher.count();
    advance(options.monitor, 1);
    begin_stage(options.monitor, "extract", 1);
    make_checked_room(mesher.size(), LabelWidth::none, field.grid.spacing, options, result.mesh);
    mesher.emit_to_host({}, result.mesh);
    advance(options.monitor, 1);
    result.grid = field.grid;
    result.stats = mesher.stats();
  }
};

// Counts and emits all bricks of a source, into a mesh in device memory. `spacing`: of the grid, Å.
DeviceExtraction mesh_on_device(const BrickSource& source, double spacing,
                                const ExtractOptions& options) {
  DeviceBrickMesher mesher(source, options);
  begin_stage(options.monitor, "field", 1);
  mesher.count();
  advance(options.monitor, 1);
  begin_stage(options.monitor, "extract", 1);
  check_mesh_limits({mesher.size(), arrays_of(options, source.label_width()), 0, spacing},
                    options.memory_limit);
  DeviceExtraction result;
  result.mesh = mesher.emit_on_device();
  advance(options.monitor, 1);
  result.candidates = mesher.candidates();
  result.timings = mesher.timings();
  result.stats = mesher.stats(result.timings);
  return result;
}

}  // namespace

DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream) {
  return mesh_on_device(SphereSource(list, model, stream), model.grid.spacing, options);
}

DeviceExtraction mesh_field_on_device(const SampledFieldView& field, const ExtractOptions& options,
                                      const Stream& stream) {
  return mesh_on_device(FieldSource(field, options, stream), field.grid.spacing, options);
}

std::unique_ptr<SurfacePart> count_part_on_cuda(const SphereSet& spheres,
                                                std::span<const SphereId> ids,
                                                const KeyRange& range,
                                                const ExtractOptions& options) {
  return std::make_unique<CudaSurfacePart>(spheres, ids, range, options);
}

std::unique_ptr<Extractor> make_cuda_extractor() { return std::make_unique<CudaExtractor>(); }

std::unique_ptr<FieldMesher> make_cuda_field_mesher() {
  return std::make_unique<CudaFieldMesher>();
}

}  // namespace vdwmesh
