// Owns the arrays of a result that a caller keeps in device memory after the call that made it.
#pragma once

#include <utility>

#include "cuda/memory/device.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// The arrays (a DeviceArray, or a struct of them with give_back_on()) go back to the pool in the
// order of the device's legacy default stream, on which most libraries read them. Precondition: the
// stream that made them has done its work; it may end before them.
template <class Arrays>
class DeviceResult {
 public:
  DeviceResult(int device, Arrays arrays) : device_(device), arrays_(std::move(arrays)) {
    arrays_.give_back_on(cudaStreamLegacy);
  }
  ~DeviceResult() {
    const QuietDeviceScope scope(device_);
    arrays_ = {};
  }
  DeviceResult(const DeviceResult&) = delete;
  DeviceResult& operator=(const DeviceResult&) = delete;

  int device() const { return device_; }
  const Arrays& arrays() const { return arrays_; }

 private:
  int device_;
  Arrays arrays_;
};

}  // namespace vdwmesh
