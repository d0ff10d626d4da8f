#include "cuda/backend.hpp"

#include <utility>

#include "core/errors.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {
namespace {

class CpuPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    ExtractOptions extraction = extract;
    if (refine.subdivisions > 0) extraction.connectivity = Connectivity::half_edges;
    ExtractResult extracted = make_cpu_extractor()->extract(spheres, extraction);
    PipelineResult result{{}, extracted.grid, extracted.stats, {}, 0};
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
    return result;
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
  return resolve(backend) == Backend::cuda ? make_cuda_refiner() : make_cpu_refiner();
}

std::unique_ptr<FieldMesher> make_field_mesher(Backend backend) {
  return resolve(backend) == Backend::cuda ? make_cuda_field_mesher() : make_cpu_field_mesher();
}

std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend) {
  if (resolve(backend) == Backend::cuda) return make_cuda_pipeline();
  return std::make_unique<CpuPipeline>();
}

}  // namespace vdwmesh
