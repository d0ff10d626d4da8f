// Arrays of moderate size that the host reads. download_parts() (transfer.cuh) is for large ones.
#pragma once

#include <cstddef>
#include <vector>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Downloads `size` values, after all work on the stream so far, and waits for them.
template <class T>
std::vector<T> fetch_values(const T* device, std::size_t size, const Stream& stream) {
  std::vector<T> values(size);
  if (size > 0) {
    check_cuda(cudaMemcpyAsync(values.data(), device, size * sizeof(T), cudaMemcpyDeviceToHost,
                               stream.get()),
               "download");
  }
  stream.wait();
  return values;
}

}  // namespace vdwmesh
