// Turns the errors of CUDA calls and kernel launches into exceptions. Every call goes through here,
// except in destructors and where an error has its own treatment.
#pragma once

#include <cuda_runtime.h>

#include <string>

#include "core/errors.hpp"

namespace vdwmesh {

// Throws unless `status` is success: DeviceMemoryExceeded if the device has no memory left,
// CudaError for every other failure. `what` begins the message. The runtime also notes the error
// for cudaGetLastError(); this note is cleared first, since check_launch() would find it after the
// next launch and blame that launch for it.
inline void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  cudaGetLastError();
  if (status == cudaErrorMemoryAllocation) {
    throw DeviceMemoryExceeded(std::string(what) + ": " + cudaGetErrorString(status));
  }
  throw CudaError(std::string(what) + ": " + cudaGetErrorString(status));
}

// Call it after a kernel launch. Reports errors of the launch itself, and errors of earlier work
// that have become known since. It does not wait for the kernel.
inline void check_launch(const char* kernel) { check_cuda(cudaGetLastError(), kernel); }

}  // namespace vdwmesh
