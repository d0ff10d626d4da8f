// Every CUDA call and launch goes through here.
#pragma once

#include <cuda_runtime.h>

#include <string>

#include "core/errors.hpp"

namespace vdwmesh {

// Throws DeviceMemoryExceeded where the device has no memory left, CudaError for every other
// failure. The runtime's own note of the error is cleared first: check_launch() would find it after
// the next launch and blame that launch for it.
inline void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  cudaGetLastError();
  if (status == cudaErrorMemoryAllocation) {
    throw DeviceMemoryExceeded(std::string(what) + ": " + cudaGetErrorString(status));
  }
  throw CudaError(std::string(what) + ": " + cudaGetErrorString(status));
}

// After a launch: its configuration errors, and those of earlier work that have surfaced.
inline void check_launch(const char* kernel) { check_cuda(cudaGetLastError(), kernel); }

}  // namespace vdwmesh
