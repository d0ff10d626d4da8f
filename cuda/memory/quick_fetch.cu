// Sends a few words from the device to the host by a kernel of one warp. If the buffer of a
// FetchPlace is not page-locked, because no such memory is left, they are copied as fetch() does.
#include <cstdint>
#include <cstring>

#include "cuda/memory/launch.cuh"
#include "cuda/memory/quick_fetch.cuh"
#include "cuda/memory/warp.cuh"

namespace vdwmesh {
namespace {

__global__ void send_words(const std::uint32_t* from, std::uint32_t* to, unsigned count) {
  for (unsigned w = threadIdx.x; w < count; w += blockDim.x) to[w] = from[w];
}

}  // namespace

void fetch_bytes_by_kernel(const void* device, void* to, std::size_t bytes, const Stream& stream) {
  const FetchPlace place;
  void* place_on_device = nullptr;
  if (cudaHostGetDevicePointer(&place_on_device, place.data(), 0) == cudaSuccess) {
    launch("fetch", send_words, {1, kWarp}, stream.get(), static_cast<const std::uint32_t*>(device),
           static_cast<std::uint32_t*>(place_on_device), bytes / sizeof(std::uint32_t));
  } else {
    cudaGetLastError();  // the failed call is no error
    check_cuda(cudaMemcpyAsync(place.data(), device, bytes, cudaMemcpyDeviceToHost, stream.get()),
               "download");
  }
  stream.wait();
  std::memcpy(to, place.data(), bytes);
}

}  // namespace vdwmesh
