// Opposite half-edges of a mesh in device memory: the counterpart of refine/half_edges.hpp.
#pragma once

#include "cuda/memory/device_structures.cuh"

namespace vdwmesh {

// What find_opposite() finds for the mesh, whose `opposite` is not looked at. Throws as it does,
// and DeviceMemoryExceeded.
DeviceArray<std::uint32_t> find_opposite_on_device(const DeviceMeshView& mesh,
                                                   const Stream& stream);

}  // namespace vdwmesh
