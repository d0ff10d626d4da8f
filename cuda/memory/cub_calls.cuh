// Calls CUB's device-wide algorithms and takes their scratch memory.
#pragma once

#include <cub/device/device_scan.cuh>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Calls algorithm(scratch, bytes), a call of a CUB algorithm, twice, as CUB requires. The first
// call has a null pointer and only writes to `bytes` how much scratch memory is needed; the second
// call does the work. At least one byte is allocated, because the pointer must not be null then.
// `what` begins the message of an error.
template <class Algorithm>
void run_cub(const char* what, cudaStream_t stream, Algorithm algorithm) {
  std::size_t bytes = 0;
  check_cuda(algorithm(nullptr, bytes), what);
  const DeviceArray<std::uint8_t> scratch(bytes > 0 ? bytes : 1, stream);
  check_cuda(algorithm(scratch.data(), bytes), what);
}

}  // namespace vdwmesh
