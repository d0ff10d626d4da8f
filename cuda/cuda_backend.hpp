// What the CUDA sources offer to backend.cpp. In builds without a CUDA compiler, unavailable.cpp
// defines these functions instead.
#pragma once

#include <memory>

#include "cuda/backend.hpp"

namespace vdwmesh {

// See cuda_devices(), share_devices() and release_device_memory() in backend.hpp.
DeviceList find_cuda_devices();
void share_cuda_devices(std::size_t process);
void release_cuda_memory();

// Precondition: a usable device is present.
std::unique_ptr<Extractor> make_cuda_extractor();
std::unique_ptr<BatchExtractor> make_cuda_batch_extractor();
std::unique_ptr<Refiner> make_cuda_refiner();
std::unique_ptr<FieldMesher> make_cuda_field_mesher();
std::unique_ptr<UnionMeasurer> make_cuda_union_measurer();
std::unique_ptr<ExactMesher> make_cuda_exact_mesher();
std::unique_ptr<DistanceMeasurer> make_cuda_distance_measurer();
std::unique_ptr<ExcludedMeasurer> make_cuda_excluded_measurer();
DeviceArcs measure_arcs_on_cuda(const SphereSet& spheres);
// A pipeline for one subdivision or more, with everything on one device. It throws
// DeviceMemoryExceeded if that does not fit.
std::unique_ptr<SurfacePipeline> make_cuda_pipeline();

}  // namespace vdwmesh
