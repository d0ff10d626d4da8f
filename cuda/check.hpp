// Every CUDA call and launch goes through here.
#pragma once

#include <cuda_runtime.h>

#include <string>

#include "core/errors.hpp"

namespace vdwmesh {

inline void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();  // or the next launch reports it again
    throw DeviceMemoryExceeded(std::string(what) + ": " + cudaGetErrorString(status));
  }
  throw CudaError(std::string(what) + ": " + cudaGetErrorString(status));
}

// After a launch: its configuration errors, and those of earlier work that have surfaced.
inline void check_launch(const char* kernel) { check_cuda(cudaGetLastError(), kernel); }

}  // namespace vdwmesh
