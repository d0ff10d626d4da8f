// Calls CUB's device-wide algorithms and takes their scratch memory.
#pragma once

#include <cub/device/device_scan.cuh>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Runs algorithm(scratch, bytes), a call of a CUB algorithm, twice, as CUB wants it: with a null
// pointer it only writes to `bytes` how much scratch memory it needs, with memory it does the work.
// The memory is never empty, because a null pointer would ask again. `what` begins the message of
// an error.
template <class Algorithm>
void run_cub(const char* what, cudaStream_t stream, Algorithm algorithm) {
  std::size_t bytes = 0;
  check_cuda(algorithm(nullptr, bytes), what);
  const DeviceArray<std::uint8_t> scratch(bytes > 0 ? bytes : 1, stream);
  check_cuda(algorithm(scratch.data(), bytes), what);
}

}  // namespace vdwmesh
