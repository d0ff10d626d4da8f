// The batch extractor on CUDA. Host threads make the cell lists of the sets side by side; the
// fields are stacked (fields.cuh) and extracted as one surface by DeviceBrickMesher; the arrays of
// all meshes are copied back together.
//
// If the sets do not fit the device together, or their stack would be too high for the keys of
// bricks, each half of them is tried, and so on. A set alone goes to the Extractor, which can cut
// it into slabs.
#include <tbb/parallel_for.h>

#include <exception>
#include <vector>

#include "core/errors.hpp"
#include "core/monitor.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/extract/batch_on_device.cuh"
#include "cuda/extract/bricks/brick_mesher.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/memory/transfer.cuh"
#include "extract/batch_extractor.hpp"
#include "extract/field_list.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

MeshArrays batch_arrays(const ExtractOptions& options) {
  return {.connectivity = options.connectivity, .normals = options.normals};
}

// The fields of a run of sets, and the cell lists that they look at.
struct RunFields {
  std::vector<CellList> lists;
  std::vector<HostField> fields;

  RunFields(const ExtractBatch& batch, const SetRun& run, const ExtractOptions& options)
      : lists(run.size()), fields(run.size()) {
    std::vector<std::exception_ptr> failures(run.size());
    tbb::parallel_for(std::size_t{0}, run.size(), [&](std::size_t i) {
      try {
        make(i, SphereSet::view(batch.spheres.set(run.begin + i)),
             grid_of_set(batch, options, run.begin + i), options);
      } catch (...) {
        failures[i] = std::current_exception();
      }
    });
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (failures[i]) throw_failure(failures[i], run.begin + i);
    }
  }

 private:
  void make(std::size_t i, const SphereSet& spheres, const GridOptions& grid,
            const ExtractOptions& options) {
    fields[i].model = make_field_model(options.field, make_grid(spheres, grid));
    lists[i] = make_field_list(spheres, fields[i].model, options.frame);
    fields[i].list = lists[i].view();
  }
  [[noreturn]] static void throw_failure(const std::exception_ptr& failure, std::size_t set) {
    try {
      std::rethrow_exception(failure);
    } catch (const Error&) {
      throw_of_set(set);
    }
  }
};

void check_sizes(const std::vector<MeshSize>& before, const std::vector<double>& spacings,
                 const ExtractOptions& options, std::size_t first_set) {
  for (std::size_t set = 0; set < spacings.size(); ++set) {
    const MeshSize size{before[set + 1].vertices - before[set].vertices,
                        before[set + 1].triangles - before[set].triangles};
    try {
      check_mesh_limits({size, batch_arrays(options), 0, spacings[set]}, kNoMemoryLimit);
    } catch (const Error&) {
      throw_of_set(first_set + set);
    }
  }
  check_batch_memory(before.back(), batch_arrays(options), options.memory_limit);
}

// Appends the meshes of the sets of a run, whose grids are those of the fields.
void append(BatchExtraction& result, const StackExtraction& made,
            const std::vector<HostField>& fields, const ExtractOptions& options,
            const Stream& stream) {
  for (std::size_t i = 0; i < fields.size() && options.on_size; ++i) {
    options.on_size({made.before[i + 1].vertices - made.before[i].vertices,
                     made.before[i + 1].triangles - made.before[i].triangles});
  }
  const MeshSize first = result.before.back();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    result.grids.push_back(fields[i].model.grid);
    result.before.push_back({first.vertices + made.before[i + 1].vertices,
                             first.triangles + made.before[i + 1].triangles});
  }
  IndexedMesh& host = result.meshes;
  make_room(host, result.before.back(), batch_arrays(options));
  const auto part = [](auto& to, std::uint64_t begin, const auto& from) {
    return DownloadPart{from.size() > 0 ? to.data() + begin : nullptr, from.data(), from.bytes()};
  };
  StageClock clock(stream.get());
  download_parts({part(host.positions, first.vertices, made.meshes.positions),
                  part(host.normals, first.vertices, made.meshes.normals),
                  part(host.vertex_spheres.atoms, first.vertices, made.meshes.vertex_spheres.atoms),
                  part(host.triangles, first.triangles, made.meshes.corners),
                  part(host.opposite, 3 * first.triangles, made.meshes.opposite)},
                 stream);
  ExtractStats stats = made.stats;
  stats.slabs = 1;
  stats.download_seconds = static_cast<double>(clock.lap()) * 1e-3;
  result.stats += stats;
}

class CudaBatchExtractor final : public BatchExtractor {
 public:
  void extract_into(BatchExtraction& result, const ExtractBatch& batch,
                    const ExtractOptions& options) const override {
    begin_batch(result, batch);
    const DeviceScope scope;
    const std::size_t sets = batch.spheres.set_count();
    begin_stage(options.monitor, "extract", sets);
    append_run(result, batch, {0, sets}, options);
  }

 private:
  static void append_run(BatchExtraction& result, const ExtractBatch& batch, const SetRun& run,
                         const ExtractOptions& options) {
    if (run.size() == 1) {
      return append_one_by_one(result, batch, run, options, *make_cuda_extractor());
    }
    if (append_together(result, batch, run, options)) return advance(options.monitor, run.size());
    const std::size_t middle = run.begin + run.size() / 2;
    append_run(result, batch, {run.begin, middle}, options);
    append_run(result, batch, {middle, run.end}, options);
  }

  // Returns false, and appends nothing, if the sets do not fit together.
  static bool append_together(BatchExtraction& result, const ExtractBatch& batch, const SetRun& run,
                              const ExtractOptions& options) {
    const RunFields run_fields(batch, run, options);
    if (!can_stack(run_fields.fields)) return false;
    ExtractOptions all = options;
    all.monitor = nullptr;  // progress counts sets
    all.memory_limit -= std::min(options.memory_limit, indexed_mesh_bytes(result.meshes));
    const Stream stream;
    StackExtraction made;
    try {
      const DeviceFieldStack stack(run_fields.fields, stream);
      made = extract_stack_on_device(stack, all, stream, run.begin);
    } catch (const DeviceMemoryExceeded&) {
      return false;
    }
    append(result, made, run_fields.fields, options, stream);
    return true;
  }
};

}  // namespace

StackExtraction extract_stack_on_device(const DeviceFieldStack& stack,
                                        const ExtractOptions& options, const Stream& stream,
                                        std::size_t first_set) {
  const StackSource source(stack, stream);
  DeviceBrickMesher mesher(source, options);
  mesher.count();
  const std::vector<BrickSums> by_layer = mesher.number_apart(stack.fields());
  StackExtraction result;
  for (const std::int32_t layer : stack.first_layers()) {
    const BrickSums& sums = by_layer[static_cast<std::size_t>(layer)];
    result.before.push_back({sums.vertices, sums.triangles});
  }
  check_sizes(result.before, stack.spacings(), options, first_set);
  result.meshes = mesher.emit_on_device();
  result.candidates = mesher.candidates();
  result.timings = mesher.timings();
  result.stats = mesher.stats(result.timings);
  return result;
}

std::unique_ptr<BatchExtractor> make_cuda_batch_extractor() {
  return std::make_unique<CudaBatchExtractor>();
}

}  // namespace vdwmesh
