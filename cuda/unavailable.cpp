// The functions of cuda_backend.hpp in a build without a CUDA compiler: there are no devices, and
// nothing can be made.
#include "core/errors.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {
namespace {

constexpr const char* kReason = "this build has no CUDA backend (no CUDA compiler was found)";

}  // namespace

DeviceList find_cuda_devices() { return {{}, kReason}; }
void release_cuda_memory() {}
std::unique_ptr<Extractor> make_cuda_extractor() { throw BackendUnavailable(kReason); }
std::unique_ptr<Refiner> make_cuda_refiner() { throw BackendUnavailable(kReason); }
std::unique_ptr<FieldMesher> make_cuda_field_mesher() { throw BackendUnavailable(kReason); }
std::unique_ptr<UnionMeasurer> make_cuda_union_measurer() { throw BackendUnavailable(kReason); }
std::unique_ptr<SurfacePipeline> make_cuda_pipeline() { throw BackendUnavailable(kReason); }

}  // namespace vdwmesh
