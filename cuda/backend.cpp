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

// Where a device is present: the CPU does what does not fit it.
class AutomaticRefiner final : public Refiner {
 public:
  RefineResult refine(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) const override {
    int next_level = 0;
    RefineOptions observed = options;
    observed.on_level = once_per_level(options.on_level, next_level);
    std::string lack;
    try {
      return make_cuda_refiner()->refine(spheres, mesh, observed);
    } catch (const DeviceMemoryExceeded& error) {
      lack = error.what();
    }
    RefineResult result = make_cpu_refiner()->refine(spheres, mesh, observed);
    result.fallback = "refined on the CPU: " + lack;
    return result;
  }
};

class AutomaticPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    int next_level = 0;
    RefineOptions options = refine;
    options.on_level = once_per_level(refine.on_level, next_level);
    std::string lack;
    try {
      return make_cuda_pipeline()->run(spheres, extract, options);
    } catch (const DeviceMemoryExceeded& error) {
      lack = error.what();
    }
    if (refine.subdivisions > 0) {
      try {
        return extract_then_refine(spheres, extract, options);
      } catch (const DeviceMemoryExceeded& error) {
        lack = error.what();
      }
    }
    PipelineResult result = CpuPipeline().run(spheres, extract, options);
    result.fallback = "meshed on the CPU: " + lack;
    return result;
  }

 private:
  // On the device too, but apart: the extraction in slabs, and without it in the way of the
  // refinement.
  static PipelineResult extract_then_refine(const SphereSet& spheres, ExtractOptions extract,
                                            RefineOptions refine) {
    const MeshSizeObserver on_size = std::exchange(extract.on_size, {});
    extract.connectivity = Connectivity::half_edges;
    const ExtractResult extracted = make_cuda_extractor()->extract(spheres, extract);
    refine.grid = extracted.grid;
    RefineResult refined = AutomaticRefiner().refine(spheres, extracted.mesh, refine);
    tell_size(on_size, refined.mesh);
    return {std::move(refined.mesh),   extracted.grid,  extracted.stats,
            std::move(refined.levels), refined.seconds, std::move(refined.fallback)};
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

std::unique_ptr<Extractor> make_extractor(Backend backend) {
  return resolve(backend) == Backend::cuda ? make_cuda_extractor() : make_cpu_extractor();
}

std::unique_ptr<Refiner> make_refiner(Backend backend) {
  if (resolve(backend) == Backend::cpu) return make_cpu_refiner();
  if (backend == Backend::cuda) return make_cuda_refiner();
  return std::make_unique<AutomaticRefiner>();
}

std::unique_ptr<FieldMesher> make_field_mesher(Backend backend) {
  return resolve(backend) == Backend::cuda ? make_cuda_field_mesher() : make_cpu_field_mesher();
}

std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend) {
  if (resolve(backend) == Backend::cpu) return std::make_unique<CpuPipeline>();
  if (backend == Backend::cuda) return make_cuda_pipeline();
  return std::make_unique<AutomaticPipeline>();
}

}  // namespace vdwmesh
