// What the CUDA room offers to backend.cpp; unavailable.cpp stands in where it is not built.
#pragma once

#include <memory>

#include "cuda/backend.hpp"

namespace vdwmesh {

DeviceList find_cuda_devices();
void release_cuda_memory();

// Precondition: a device is present.
std::unique_ptr<Extractor> make_cuda_extractor();
std::unique_ptr<Refiner> make_cuda_refiner();
std::unique_ptr<FieldMesher> make_cuda_field_mesher();
// For subdivisions, with everything on one device: throws DeviceMemoryExceeded if that does not
// fit.
std::unique_ptr<SurfacePipeline> make_cuda_pipeline();

}  // namespace vdwmesh
