// The functions of cuda_backend.hpp and on_device.hpp in a build without a CUDA compiler: there are
// no devices, and nothing can be made.
#include "core/errors.hpp"
#include "cuda/count_part.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/on_device.hpp"

namespace vdwmesh {
namespace {

constexpr const char* kReason = "this build has no CUDA backend (no CUDA compiler was found)";

}  // namespace

DeviceList find_cuda_devices() { return {{}, kReason}; }
void share_cuda_devices(std::size_t) {}
void release_cuda_memory() {}
std::unique_ptr<Extractor> make_cuda_extractor() { throw BackendUnavailable(kReason); }
std::unique_ptr<SurfacePart> count_part_on_cuda(const SphereSet&, std::span<const SphereId>,
                                                const KeyRange&, const ExtractOptions&) {
  throw BackendUnavailable(kReason);
}
std::unique_ptr<BatchExtractor> make_cuda_batch_extractor() { throw BackendUnavailable(kReason); }
std::unique_ptr<Refiner> make_cuda_refiner() { throw BackendUnavailable(kReason); }
std::unique_ptr<FieldMesher> make_cuda_field_mesher() { throw BackendUnavailable(kReason); }
std::unique_ptr<UnionMeasurer> make_cuda_union_measurer() { throw BackendUnavailable(kReason); }
std::unique_ptr<ExactMesher> make_cuda_exact_mesher() { throw BackendUnavailable(kReason); }
std::unique_ptr<DistanceMeasurer> make_cuda_distance_measurer() {
  throw BackendUnavailable(kReason);
}
std::unique_ptr<ExcludedMeasurer> make_cuda_excluded_measurer() {
  throw BackendUnavailable(kReason);
}
std::unique_ptr<SurfacePipeline> make_cuda_pipeline() { throw BackendUnavailable(kReason); }
DeviceArcs measure_arcs_on_cuda(const SphereSet&) { throw BackendUnavailable(kReason); }

int device_of(const void*, const char* name) {
  throw BackendUnavailable(std::string(name) + ": is on a CUDA device, but " + kReason);
}
void copy_to_host(void*, const void*, std::size_t, int) { throw BackendUnavailable(kReason); }
void wait_for_stream(int, std::uintptr_t) { throw BackendUnavailable(kReason); }
DeviceFrames::DeviceFrames(int, const FrameCoordinates&, const DeviceNumbers&, double) {
  throw BackendUnavailable(kReason);
}
DeviceFrames::DeviceFrames(int, const FrameCoordinates&, std::span<const double>, double) {
  throw BackendUnavailable(kReason);
}
DeviceFrames::DeviceFrames(const SphereSet&) { throw BackendUnavailable(kReason); }
std::size_t DeviceFrames::atoms() const { throw BackendUnavailable(kReason); }
std::size_t DeviceFrames::valid_frames() const { throw BackendUnavailable(kReason); }
const std::optional<InvalidFrame>& DeviceFrames::invalid() const {
  throw BackendUnavailable(kReason);
}
const Box& DeviceFrames::balls() const { throw BackendUnavailable(kReason); }
const Box& DeviceFrames::centers() const { throw BackendUnavailable(kReason); }
double DeviceFrames::least_radius() const { throw BackendUnavailable(kReason); }
CudaMesh mesh_on_device(const DeviceFrames&, const ExtractOptions&, const RefineOptions&) {
  throw BackendUnavailable(kReason);
}
CudaExactMesh exact_mesh_on_device(const DeviceFrames&, const ExactMeshOptions&,
                                   const RefineOptions&) {
  throw BackendUnavailable(kReason);
}
const CudaMeshArrays& CudaMesh::arrays() const { throw BackendUnavailable(kReason); }
IndexedMesh CudaMesh::download() const { throw BackendUnavailable(kReason); }
int CudaMeasures::device() const { throw BackendUnavailable(kReason); }
const SphereMeasures* CudaMeasures::rows() const { throw BackendUnavailable(kReason); }
const BallGradient* CudaMeasures::gradients() const { throw BackendUnavailable(kReason); }
CudaMeasures measure_on_device(std::vector<ExactUnion>&, const DeviceFrames&, const FrameOptions&) {
  throw BackendUnavailable(kReason);
}
CudaMeasures gradients_on_device(std::vector<ExactUnion>&, std::vector<std::uint64_t>&,
                                 const DeviceFrames&, const BatchWeights&, const FrameOptions&) {
  throw BackendUnavailable(kReason);
}
CudaMeasures sets_on_device(BatchMeasures&, std::vector<std::uint64_t>&, const DeviceFrames&,
                            std::span<const std::size_t>, const BatchWeights*, Monitor*) {
  throw BackendUnavailable(kReason);
}

}  // namespace vdwmesh
