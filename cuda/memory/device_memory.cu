// Allocates device memory from the default pool of the current device; if that fails, the pool
// gives its unused memory back to the driver, and the allocation is tried once more. Staging
// buffers are page-locked if the system has such memory to give. A FetchPlace takes its buffer from
// a list of free ones and puts it back there.
#include <mutex>

#include "cuda/memory/device.cuh"
#include "cuda/memory/device_memory.cuh"
#include "cuda/memory/launch.cuh"

namespace vdwmesh {
namespace {

// The free staging buffers of FetchPlace. Never destroyed: at the end of the process the driver may
// be gone already.
struct FreePlaces {
  std::mutex mutex;
  std::vector<std::unique_ptr<StagingBuffer>> places;
};
FreePlaces& free_places() {
  static auto* const all = new FreePlaces;
  return *all;
}

// By one thread block.
__global__ void copy_words(const std::uint32_t* from, std::uint32_t* to, unsigned count) {
  for (unsigned w = threadIdx.x; w < count; w += blockDim.x) to[w] = from[w];
}

}  // namespace

void* allocate_on_device(std::size_t bytes, cudaStream_t stream) {
  void* memory = nullptr;
  cudaError_t status = cudaMallocAsync(&memory, bytes, stream);
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    // Arrays that the stream has yet to give back count as unused only after the wait.
    check_cuda(cudaStreamSynchronize(stream), "waiting for the device");
    check_cuda(cudaMemPoolTrimTo(current_memory_pool(), 0), "memory pool");
    status = cudaMallocAsync(&memory, bytes, stream);
  }
  check_cuda(status, "device memory");
  return memory;
}

StagingBuffer::StagingBuffer(std::size_t bytes) {
  const cudaError_t status = cudaHostAlloc(&locked_, bytes, cudaHostAllocPortable);
  if (status == cudaSuccess) return;
  cudaGetLastError();
  locked_ = nullptr;
  if (status != cudaErrorMemoryAllocation) check_cuda(status, "page-locked memory");
  ordinary_ = std::make_unique_for_overwrite<std::byte[]>(bytes);
}

StagingBuffer::~StagingBuffer() {
  if (locked_ != nullptr) cudaFreeHost(locked_);
}

// With unified addressing, which all devices here have, page-locked memory has one address for host
// and device.
void FetchPlace::copy(const void* device, std::size_t bytes, cudaStream_t stream) const {
  if (place_->is_locked()) {
    launch("fetch", copy_words, {1, 32}, stream, static_cast<const std::uint32_t*>(device),
           static_cast<std::uint32_t*>(place_->data()), bytes / sizeof(std::uint32_t));
  } else {
    check_cuda(cudaMemcpyAsync(place_->data(), device, bytes, cudaMemcpyDeviceToHost, stream),
               "download");
  }
}

FetchPlace::Place FetchPlace::take() {
  FreePlaces& all = free_places();
  const std::lock_guard lock(all.mutex);
  if (all.places.empty()) return std::make_unique<StagingBuffer>(kFetchBytes);
  Place place = std::move(all.places.back());
  all.places.pop_back();
  return place;
}

void FetchPlace::give_back(Place place) {
  FreePlaces& all = free_places();
  const std::lock_guard lock(all.mutex);
  all.places.push_back(std::move(place));
}

}  // namespace vdwmesh
