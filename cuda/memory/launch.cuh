// Starting kernels: the shape of a launch, and the check for errors that follows every launch.
#pragma once

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// The index of the thread in a one-dimensional grid.
__device__ inline std::uint64_t thread_index() {
  return static_cast<std::uint64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
}

struct LaunchShape {
  dim3 blocks;
  unsigned threads;        // of a block
  std::size_t shared = 0;  // bytes of dynamic shared memory of a block
};

// Blocks of so many threads, each for `per_block` of the items.
inline LaunchShape over(std::uint64_t items, unsigned per_block, unsigned threads) {
  return {blocks_for(items, per_block), threads};
}
// A thread for each item.
inline LaunchShape over(std::uint64_t items, unsigned threads) {
  return over(items, threads, threads);
}

// Starts the kernel, unless there is nothing to do: no blocks. The arguments are converted to the
// types of the kernel's parameters. `name` stands in the message of a CudaError.
template <class... Parameters, class... Arguments>
void launch(const char* name, void (*kernel)(Parameters...), const LaunchShape& shape,
            cudaStream_t stream, const Arguments&... arguments) {
  if (shape.blocks.x == 0) return;
  kernel<<<shape.blocks, shape.threads, shape.shared, stream>>>(
      static_cast<Parameters>(arguments)...);
  check_launch(name);
}

}  // namespace vdwmesh
