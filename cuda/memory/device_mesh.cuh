// A mesh that a caller keeps in device memory: what is behind a CudaMesh.
#pragma once

#include <utility>

#include "cuda/memory/device_result.cuh"
#include "cuda/memory/device_structures.cuh"
#include "cuda/on_device.hpp"

namespace vdwmesh {

struct CudaMesh::Data : DeviceResult<DeviceMesh> {
  Data(int on, DeviceMesh made);
  CudaMeshArrays view;
};

// Precondition: the stream that made the mesh has done its work.
CudaMesh kept_mesh(int device, DeviceMesh made);

}  // namespace vdwmesh
