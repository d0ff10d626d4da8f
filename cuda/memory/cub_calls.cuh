// CUB's device-wide algorithms with their scratch memory taken care of.
#pragma once

#include <cub/device/device_scan.cuh>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Runs a CUB algorithm: the first call asks for its scratch memory, the second does the work.
template <class Algorithm>
void run_cub(const char* what, cudaStream_t stream, Algorithm algorithm) {
  std::size_t bytes = 0;
  check_cuda(algorithm(nullptr, bytes), what);
  const DeviceArray<std::uint8_t> scratch(bytes > 0 ? bytes : 1, stream);
  check_cuda(algorithm(scratch.data(), bytes), what);
}

}  // namespace vdwmesh
