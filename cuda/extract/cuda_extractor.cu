// The Extractor on CUDA.
#include "cuda/cuda_backend.hpp"
#include "cuda/extract/extract_in_slabs.cuh"

namespace vdwmesh {
namespace {

class CudaExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    return extract_to_host(spheres, options);
  }
};

}  // namespace

std::unique_ptr<Extractor> make_cuda_extractor() { return std::make_unique<CudaExtractor>(); }

}  // namespace vdwmesh
