// The Refiner on CUDA.
#include "core/errors.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {

std::unique_ptr<Refiner> make_cuda_refiner() {
  throw BackendUnavailable("refinement on CUDA is not there yet; use the cpu backend");
}

}  // namespace vdwmesh
