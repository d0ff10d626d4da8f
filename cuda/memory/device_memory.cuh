// Owners of device memory, streams, events and page-locked host memory. Destructors give everything
// back and ignore errors. check_cuda() (check.hpp) throws if a CUDA call has failed. "In stream
// order" means: memory is taken and given back between the other work of a stream, without waiting
// for it.
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
#include "cuda/memory/check.hpp"

namespace vdwmesh {

// A CUDA stream of its own, which does not wait for the default stream.
class Stream {
 public:
  Stream() { check_cuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "stream"); }
  ~Stream() { cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  cudaStream_t get() const { return stream_; }
  operator cudaStream_t() const { return stream_; }
  void wait() const { check_cuda(cudaStreamSynchronize(stream_), "waiting for the device"); }

 private:
  cudaStream_t stream_ = nullptr;
};

// Takes bytes from the memory pool of the current device, in stream order. If that fails, the pool
// gives the memory that it keeps unused back to the driver, and the allocation is tried once more:
// the pool may hold enough, in pieces that are too small. Throws DeviceMemoryExceeded if the second
// attempt fails too.
void* allocate_on_device(std::size_t bytes, cudaStream_t stream);

// An uninitialised array in device memory, taken by allocate_on_device() and given back in stream
// order to the same stream. An empty array has a null pointer.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(std::size_t size, cudaStream_t stream) : size_(size), stream_(stream) {
    if (size > 0) data_ = static_cast<T*>(allocate_on_device(size * sizeof(T), stream));
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
  // From now on the destructor gives the memory back in the order of another stream. So an array
  // may outlive the stream that it was taken from, once that stream has done its work.
  void give_back_on(cudaStream_t stream) { stream_ = stream; }

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

// Fills an array with zero bytes, in stream order.
template <class T>
void clear(const DeviceArray<T>& array, cudaStream_t stream) {
  if (array.size() > 0) {
    check_cuda(cudaMemsetAsync(array.data(), 0, array.bytes(), stream), "clearing device memory");
  }
}

// Copies `size` values from the host to a new array, in stream order.
template <class T>
DeviceArray<T> zeros(std::size_t size, cudaStream_t stream) {
  DeviceArray<T> array(size, stream);
  clear(array, stream);
  return array;
}

// Copies the array `from`, which `kind` says lies on the host or on the device.
template <class T>
DeviceArray<T> copy_of(const T* from, std::size_t size, cudaStream_t stream,
                       cudaMemcpyKind kind = cudaMemcpyDeviceToDevice) {
  DeviceArray<T> copy(size, stream);
  if (size > 0) {
    check_cuda(cudaMemcpyAsync(copy.data(), from, copy.bytes(), kind, stream),
               "copy to the device");
  }
  return copy;
}

// Returns once the caller may change or free the memory of the host that a copy to the device
// reads. The runtime stages pageable memory before it returns, except on devices that read pageable
// memory themselves (as Grace Hopper does): there the copy is waited for.
void end_upload(cudaStream_t stream);

template <class T>
DeviceArray<T> upload(const T* host, std::size_t size, cudaStream_t stream) {
  DeviceArray<T> copy = copy_of(host, size, stream, cudaMemcpyHostToDevice);
  if (size > 0) end_upload(stream);
  return copy;
}

// Host memory into which copies from the device go. Its pages are locked, so that the device writes
// them directly, without a copy by the driver. If the system grants no more locked pages, it is
// ordinary memory: the copies are slower, but right. Throws std::bad_alloc.
class StagingBuffer {
 public:
  explicit StagingBuffer(std::size_t bytes);
  ~StagingBuffer();
  StagingBuffer(const StagingBuffer&) = delete;
  StagingBuffer& operator=(const StagingBuffer&) = delete;

  void* data() const { return locked_ != nullptr ? locked_ : ordinary_.get(); }

 private:
  void* locked_ = nullptr;
  std::unique_ptr<std::byte[]> ordinary_;
};

// A staging buffer for one fetch(). The destructor puts the buffer back into a list from which the
// next FetchPlace takes it: locking pages takes far longer than fetching.
inline constexpr std::size_t kFetchBytes = 4096;
class FetchPlace {
 public:
  FetchPlace() : place_(take()) {}
  ~FetchPlace() { give_back(std::move(place_)); }
  FetchPlace(const FetchPlace&) = delete;
  FetchPlace& operator=(const FetchPlace&) = delete;
  void* data() const { return place_->data(); }

 private:
  using Place = std::unique_ptr<StagingBuffer>;
  static Place take();
  static void give_back(Place place);

  Place place_;
};

// Downloads one value, after all work on the stream so far, and waits for it.
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

class Event {
 public:
  explicit Event(unsigned flags = cudaEventDefault) {
    check_cuda(cudaEventCreateWithFlags(&event_, flags), "event");
  }
  ~Event() {
    if (event_ != nullptr) cudaEventDestroy(event_);
  }
  Event(Event&& other) noexcept : event_(std::exchange(other.event_, nullptr)) {}
  Event& operator=(Event&&) = delete;

  cudaEvent_t get() const { return event_; }
  void record(cudaStream_t stream) const { check_cuda(cudaEventRecord(event_, stream), "event"); }
  void wait() const { check_cuda(cudaEventSynchronize(event_), "event"); }

 private:
  cudaEvent_t event_ = nullptr;
};

inline float milliseconds_between(const Event& start, const Event& stop) {
  float milliseconds = 0;
  check_cuda(cudaEventElapsedTime(&milliseconds, start.get(), stop.get()), "event");
  return milliseconds;
}

// Measures laps on a stream in milliseconds of device time. Each lap() waits for the device.
class StageClock {
 public:
  explicit StageClock(cudaStream_t stream) : stream_(stream) { restart(); }

  void restart() { start_.record(stream_); }
  // Returns the time since construction, restart() or the last lap(), after waiting for the work so
  // far. The next lap begins.
  float lap() {
    stop_.record(stream_);
    stop_.wait();
    const float milliseconds = milliseconds_between(start_, stop_);
    restart();
    return milliseconds;
  }

 private:
  cudaStream_t stream_;
  Event start_, stop_;
};

// Marks on a stream: mark() only records an event and waits for nothing. The times between marks
// can be asked later.
class StageMarks {
 public:
  explicit StageMarks(cudaStream_t stream) : stream_(stream) { mark(); }

  void mark() { events_.emplace_back().record(stream_); }
  // Milliseconds between marks i and i + 1, after waiting for both. The constructor makes mark 0.
  float stage(std::size_t i) const {
    events_.at(i + 1).wait();
    return milliseconds_between(events_.at(i), events_.at(i + 1));
  }

 private:
  cudaStream_t stream_;
  std::vector<Event> events_;
};

// Blocks of `threads` threads that are needed for `items` items, one thread per item.
inline unsigned blocks_for(std::uint64_t items, unsigned threads) {
  return static_cast<unsigned>((items + threads - 1) / threads);
}

}  // namespace vdwmesh
