// Allocates device memory from the backend's pool of the current device; if that fails, the pool
// gives its unused memory back to the driver, and the allocation is tried once more. Staging
// buffers are page-locked if the system has such memory to give. A FetchPlace takes its buffer from
// a list of free ones and puts it back there.
#include <mutex>

#include "cuda/memory/device.cuh"
#include "cuda/memory/device_memory.cuh"

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

}  // namespace

void* allocate_on_device(std::size_t bytes, cudaStream_t stream) {
  void* memory = nullptr;
  const cudaMemPool_t pool = current_memory_pool();
  cudaError_t status = cudaMallocFromPoolAsync(&memory, bytes, pool, stream);
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();
    // Arrays that the stream has yet to give back count as unused only after the wait.
    check_cuda(cudaStreamSynchronize(stream), "waiting for the device");
    check_cuda(cudaMemPoolTrimTo(pool, 0), "memory pool");
    status = cudaMallocFromPoolAsync(&memory, bytes, pool, stream);
  }
  check_cuda(status, "device memory");
  return memory;
}

void end_upload(cudaStream_t stream) {
  if (reads_pageable_memory()) check_cuda(cudaStreamSynchronize(stream), "upload");
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
