// Executes the steps of ElementPipeline on a CUDA device: a thread for each element.
#pragma once

#include <thrust/iterator/counting_iterator.h>

#include <bit>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>
#include <limits>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "cuda/measure/batch_cells.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/fetch_values.cuh"
#include "cuda/memory/launch.cuh"
#include "cuda/memory/transfer.cuh"
#include "excluded/elements/element_pipeline.hpp"

namespace vdwmesh::excluded::elements {

// A thread for each element.
template <class Step>
__global__ void execute_step(Step step, std::uint64_t count) {
  const std::uint64_t i = thread_index();
  if (i < count) step(i);
}

class DeviceExecutor {
 public:
  explicit DeviceExecutor(const Stream& stream) : stream_(stream) {}

  template <class T>
  using Array = DeviceArray<T>;

  template <class T>
  DeviceArray<T> make(std::size_t size) const {
    return DeviceArray<T>(size, stream_);
  }
  template <class T>
  DeviceArray<T> zeros(std::size_t size) const {
    return vdwmesh::zeros<T>(size, stream_);
  }
  template <class T>
  DeviceArray<T> upload(const std::vector<T>& from) const {
    return vdwmesh::upload(from.data(), from.size(), stream_.get());
  }
  template <class T>
  std::vector<T> download(const T* from, std::size_t size) const {
    return fetch_values(from, size, stream_);
  }
  // Of much memory.
  template <class T>
  void download_to(T* to, const T* from, std::size_t size) const {
    download_parts({{to, from, size * sizeof(T)}}, stream_);
  }
  template <class T>
  void put(const DeviceArray<T>& array, std::size_t place, const T& value) const {
    check_cuda(cudaMemcpyAsync(array.data() + place, &value, sizeof(T), cudaMemcpyHostToDevice,
                               stream_.get()),
               "upload");
    stream_.wait();
  }
  template <class Step>
  void run(const char* name, std::uint64_t count, const Step& step) const {
    launch(name, execute_step<Step>, over(count, kThreads), stream_, step, count);
  }
  // Waits for the device.
  std::uint64_t scan(const DeviceArray<std::uint64_t>& counts) const {
    run_cub("elements", stream_, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveSum(scratch, bytes, counts.data(),
                                           static_cast<std::int64_t>(counts.size()), stream_.get());
    });
    const std::uint64_t total = fetch(counts.data() + counts.size() - 1, stream_);
    if (total > std::numeric_limits<std::uint32_t>::max() / 8) {
      throw DeviceMemoryExceeded(
          "the excluded surface has " + std::to_string(total) +
          " elements of one kind, a device numbers at most 2^29: choose the cpu backend");
    }
    return total;
  }
  // Waits for the device.
  DeviceArray<std::uint32_t> select(const DeviceArray<std::uint8_t>& flags,
                                    std::uint64_t count) const;
  void sort(DeviceArray<std::uint32_t>& keys, DeviceArray<std::uint32_t>& values,
            std::uint64_t end) const;
  // Of low probes.
  OverlapLists<DeviceExecutor> overlaps(const DeviceArray<Sphere>& balls,
                                        const DeviceArray<std::uint32_t>& set,
                                        std::size_t sets) const;
  // Of the balls of a list that have an exposed part, by list place.
  OverlapLists<DeviceExecutor> overlaps(const measure::BatchCellsView& list,
                                        const SphereMeasures* measures) const;

 private:
  static constexpr unsigned kThreads = 128;

  const Stream& stream_;
};

}  // namespace vdwmesh::excluded::elements
