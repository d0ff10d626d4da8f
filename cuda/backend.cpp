#include "cuda/backend.hpp"

#include <utility>

#include "core/errors.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {
namespace {

void tell_size(const MeshSizeObserver& observer, const IndexedMesh& mesh) {
  if (observer) observer({mesh.vertex_count(), mesh.triangle_count()});
}

class CpuPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    ExtractOptions extraction = extract;
    if (refine.subdivisions > 0) {
      extraction.connectivity = Connectivity::half_edges;
      extraction.on_size = {};
    }
    ExtractResult extracted = make_cpu_extractor()->extract(spheres, extraction);
    PipelineResult result{{}, extracted.grid, extracted.stats, {}, 0, {}};
    if (refine.subdivisions == 0) {
      result.mesh = std::move(extracted.mesh);
      return result;
    }
    RefineOptions options = refine;
    options.grid = extracted.grid;
    RefineResult refined = make_cpu_refiner()->refine(spheres, extracted.mesh, options);
    result.mesh = std::move(refined.mesh);
    result.levels = std::move(refined.levels);
    result.refine_seconds = refined.seconds;
    tell_size(extract.on_size, result.mesh);
    return result;
  }
};

// Passes each level on once, also where a second attempt sees it again: its bits are the same.
LevelObserver once_per_level(const LevelObserver& observer, int& next) {
  if (!observer) return {};
  return [&observer, &next](int level, const IndexedMesh& mesh) {
    if (level < next) return;
    next = level + 1;
    observer(level, mesh);
  };
}

// on_device(), or where that does not fit the device's memory on_cpu(), whose result then says so:
// "`done` on the CPU: ...".
template <class OnDevice, class OnCpu>
auto with_fallback(const char* done, const OnDevice& on_device, const OnCpu& on_cpu) {
  std::string lack;
  try {
    return on_device();
  } catch (const DeviceMemoryExceeded& error) {
    lack = error.what();
  }
  auto result = on_cpu();
  result.fallback = std::string(done) + " on the CPU: " + lack;
  return result;
}

// The automatic classes are for where a device is present: the CPU does what does not fit it.
class AutomaticExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    return with_fallback(
        "meshed", [&] { return make_cuda_extractor()->extract(spheres, options); },
        [&] { return make_cpu_extractor()->extract(spheres, options); });
  }
};

class AutomaticFieldMesher final : public FieldMesher {
 public:
  SampledField sample(const SphereSet& spheres, const ExtractOptions& options) const override {
    return with_fallback(
        "sampled", [&] { return make_cuda_field_mesher()->sample(spheres, options); },
        [&] { return make_cpu_field_mesher()->sample(spheres, options); });
  }
  ExtractResult mesh(const SampledField& field, const ExtractOptions& options) const override {
    return with_fallback(
        "meshed", [&] { return make_cuda_field_mesher()->mesh(field, options); },
        [&] { return make_cpu_field_mesher()->mesh(field, options); });
  }
};

class AutomaticRefiner final : public Refiner {
 public:
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const override {
    int next_level = 0;
    RefineOptions observed = options;
    observed.on_level = once_per_level(options.on_level, next_level);
    return with_fallback(
        "refined", [&] { return make_cuda_refiner()->refine(spheres, mesh, observed); },
        [&] { return make_cpu_refiner()->refine(spheres, mesh, observed); });
  }
};

// On CUDA, `refiner` being that of the way over the host.
PipelineResult run_on_device(const SphereSet& spheres, const ExtractOptions& extract,
                             const RefineOptions& refine, const Refiner& refiner) {
  if (refine.subdivisions == 0) return make_cuda_pipeline()->run(spheres, extract, refine);
  if (extract.devices == 1) {
    try {
      return make_cuda_pipeline()->run(spheres, extract, refine);
    } catch (const DeviceMemoryExceeded&) {
      // Apart it may fit: the extraction in slabs, and the refinement without it in the way.
    }
  }
  ExtractOptions extraction = extract;
  extraction.on_size = {};
  extraction.connectivity = Connectivity::half_edges;
  const ExtractResult extracted = make_cuda_extractor()->extract(spheres, extraction);
  RefineOptions options = refine;
  options.grid = extracted.grid;
  RefineResult refined = refiner.refine(spheres, extracted.mesh, options);
  tell_size(extract.on_size, refined.mesh);
  return {std::move(refined.mesh),   extracted.grid,  extracted.stats,
          std::move(refined.levels), refined.seconds, std::move(refined.fallback)};
}

class CudaPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    int next_level = 0;
    RefineOptions observed = refine;
    observed.on_level = once_per_level(refine.on_level, next_level);
    return run_on_device(spheres, extract, observed, *make_cuda_refiner());
  }
};

class AutomaticPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    int next_level = 0;
    RefineOptions observed = refine;
    observed.on_level = once_per_level(refine.on_level, next_level);
    return with_fallback(
        "meshed", [&] { return run_on_device(spheres, extract, observed, AutomaticRefiner()); },
        [&] { return CpuPipeline().run(spheres, extract, observed); });
  }
};

}  // namespace

DeviceList cuda_devices() { return find_cuda_devices(); }

Backend resolve(Backend requested) {
  if (requested == Backend::cpu) return Backend::cpu;
  const DeviceList list = cuda_devices();
  if (!list.devices.empty()) return Backend::cuda;
  if (requested == Backend::automatic) return Backend::cpu;
  throw BackendUnavailable("the CUDA backend is not there: " + list.reason);
}

void release_device_memory() { release_cuda_memory(); }

std::unique_ptr<Extractor> make_extractor(Backend backend) {
  if (resolve(backend) == Backend::cpu) return make_cpu_extractor();
  if (backend == Backend::cuda) return make_cuda_extractor();
  return std::make_unique<AutomaticExtractor>();
}

std::unique_ptr<Refiner> make_refiner(Backend backend) {
  if (resolve(backend) == Backend::cpu) return make_cpu_refiner();
  if (backend == Backend::cuda) return make_cuda_refiner();
  return std::make_unique<AutomaticRefiner>();
}

std::unique_ptr<FieldMesher> make_field_mesher(Backend backend) {
  if (resolve(backend) == Backend::cpu) return make_cpu_field_mesher();
  if (backend == Backend::cuda) return make_cuda_field_mesher();
  return std::make_unique<AutomaticFieldMesher>();
}

std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend) {
  if (resolve(backend) == Backend::cpu) return std::make_unique<CpuPipeline>();
  if (backend == Backend::cuda) return std::make_unique<CudaPipeline>();
  return std::make_unique<AutomaticPipeline>();
}

}  // namespace vdwmesh
