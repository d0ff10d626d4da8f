// Extraction and refinement on CUDA, everything staying on the device in between.
#include "core/errors.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {
namespace {

class CudaPipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    if (refine.subdivisions > 0) make_cuda_refiner();
    ExtractResult extracted = make_cuda_extractor()->extract(spheres, extract);
    return {std::move(extracted.mesh), extracted.grid, extracted.stats, {}, 0};
  }
};

}  // namespace

std::unique_ptr<SurfacePipeline> make_cuda_pipeline() { return std::make_unique<CudaPipeline>(); }

}  // namespace vdwmesh
