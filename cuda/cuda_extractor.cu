// The Extractor on CUDA.
#include "cuda/cuda_backend.hpp"
#include "cuda/device_structures.cuh"
#include "extract/field_sample.hpp"

namespace vdwmesh {
namespace {

class CudaExtractor final : public Extractor {
 public:
  ExtractResult extract(const SphereSet& spheres, const ExtractOptions& options) const override {
    const GridSpec grid = make_grid(spheres, options.grid);
    const FieldModel model = make_field_model(options.field, grid);
    const CellList list = make_field_list(spheres, model);
    const Stream stream;
    const DeviceCellList device_list(list.view(), stream.get());
    const DeviceExtraction extraction =
        extract_on_device(device_list.view(), model, options, stream);
    return {download(extraction.mesh.view(), options.connectivity, stream), grid, extraction.stats};
  }
};

}  // namespace

std::unique_ptr<Extractor> make_cuda_extractor() { return std::make_unique<CudaExtractor>(); }

}  // namespace vdwmesh
