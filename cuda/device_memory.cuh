// Owners of device memory, streams and events.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "cuda/check.hpp"

namespace vdwmesh {

class Stream {
 public:
  Stream() { check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "stream"); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  cudaStream_t get() const { return stream_; }
  void wait() const { check_cuda(cudaStreamSynchronize(stream_), "waiting for the device"); }

 private:
  cudaStream_t stream_ = nullptr;
};

// An array in device memory, taken from the device's pool in stream order.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(std::size_t size, cudaStream_t stream) : size_(size), stream_(stream) {
    if (size > 0) {
      check_cuda(cudaMallocAsync(reinterpret_cast<void**>(&data_), size * sizeof(T), stream),
                 "device memory");
    }
  }
  ~DeviceArray() {
    if (data_) cudaFreeAsync(data_, stream_);
  }
  DeviceArray(DeviceArray&& other) noexcept { swap(other); }
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    DeviceArray taken(std::move(other));
    swap(taken);
    return *this;
  }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  void swap(DeviceArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(stream_, other.stream_);
  }
  T* data_ = nullptr;
  std::size_t size_ = 0;
  cudaStream_t stream_ = nullptr;
};

template <class T>
void clear(const DeviceArray<T>& array, cudaStream_t stream) {
  if (array.size() > 0) {
    check_cuda(cudaMemsetAsync(array.data(), 0, array.bytes(), stream), "clearing device memory");
  }
}

template <class T>
DeviceArray<T> upload(const T* host, std::size_t size, cudaStream_t stream) {
  DeviceArray<T> device(size, stream);
  if (size > 0) {
    check_cuda(
        cudaMemcpyAsync(device.data(), host, size * sizeof(T), cudaMemcpyHostToDevice, stream),
        "upload");
  }
  return device;
}

// Page-locked memory, which the device writes without a copy by the driver.
class PageLocked {
 public:
  explicit PageLocked(std::size_t bytes) {
    check_cuda(cudaHostAlloc(&data_, bytes, cudaHostAllocPortable), "page-locked memory");
  }
  ~PageLocked() { cudaFreeHost(data_); }
  PageLocked(const PageLocked&) = delete;
  PageLocked& operator=(const PageLocked&) = delete;

  void* data() const { return data_; }

 private:
  void* data_ = nullptr;
};

// Page-locked memory for one fetch. Given back, it waits for the next one: locking takes far longer
// than fetching.
inline constexpr std::size_t kFetchBytes = 4096;
class FetchPlace {
 public:
  FetchPlace() : place_(take()) {}
  ~FetchPlace() { give_back(std::move(place_)); }
  FetchPlace(const FetchPlace&) = delete;
  FetchPlace& operator=(const FetchPlace&) = delete;
  void* data() const { return place_->data(); }

 private:
  using Place = std::unique_ptr<PageLocked>;
  static Place take();
  static void give_back(Place place);

  Place place_;
};

// One value from the device; waits for it.
template <class T>
T fetch(const T* device, const Stream& stream) {
  static_assert(sizeof(T) <= kFetchBytes && std::is_trivially_copyable_v<T>);
  const FetchPlace place;
  check_cuda(cudaMemcpyAsync(place.data(), device, sizeof(T), cudaMemcpyDeviceToHost, stream.get()),
             "download");
  stream.wait();
  T value{};
  std::memcpy(&value, place.data(), sizeof(T));
  return value;
}

// Milliseconds between marks on a stream.
class StageClock {
 public:
  explicit StageClock(cudaStream_t stream) : stream_(stream) {
    check_cuda(cudaEventCreate(&start_), "event");
    check_cuda(cudaEventCreate(&stop_), "event");
    restart();
  }
  ~StageClock() {
    cudaEventDestroy(start_);
    cudaEventDestroy(stop_);
  }
  StageClock(const StageClock&) = delete;
  StageClock& operator=(const StageClock&) = delete;

  void restart() { check_cuda(cudaEventRecord(start_, stream_), "event"); }
  // Waits for the work so far and starts anew.
  float lap() {
    check_cuda(cudaEventRecord(stop_, stream_), "event");
    check_cuda(cudaEventSynchronize(stop_), "event");
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, start_, stop_), "event");
    restart();
    return milliseconds;
  }

 private:
  cudaStream_t stream_;
  cudaEvent_t start_ = nullptr, stop_ = nullptr;
};

// Marks on a stream whose times are asked for later, so that marking waits for nothing.
class StageMarks {
 public:
  explicit StageMarks(cudaStream_t stream) : stream_(stream) { mark(); }
  ~StageMarks() {
    for (const cudaEvent_t event : events_) cudaEventDestroy(event);
  }
  StageMarks(const StageMarks&) = delete;
  StageMarks& operator=(const StageMarks&) = delete;

  void mark() {
    cudaEvent_t event = nullptr;
    check_cuda(cudaEventCreate(&event), "event");
    events_.push_back(event);
    check_cuda(cudaEventRecord(event, stream_), "event");
  }
  // ms between marks i and i + 1, the first being the construction; waits for them.
  float stage(std::size_t i) const {
    check_cuda(cudaEventSynchronize(events_.at(i + 1)), "event");
    float milliseconds = 0;
    check_cuda(cudaEventElapsedTime(&milliseconds, events_.at(i), events_.at(i + 1)), "event");
    return milliseconds;
  }

 private:
  cudaStream_t stream_;
  std::vector<cudaEvent_t> events_;
};

inline unsigned blocks_for(std::uint64_t items, unsigned threads) {
  return static_cast<unsigned>((items + threads - 1) / threads);
}

}  // namespace vdwmesh
