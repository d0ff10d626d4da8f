// The CUDA devices that this build can use, and the one that a call works on.
#pragma once

#include <cuda_runtime.h>

#include <vector>

namespace vdwmesh {

// CUDA's numbers of the devices for which this build has code and which have memory pools, rising.
std::vector<int> usable_devices();

// Makes the device current on this thread. The first time its memory pool is told to keep what is
// given back, so that the next allocation does not wait for the driver: release_device_memory().
void use_device(int device);

// While it lives a usable device is current on this thread: the one that was so before, or else the
// first. Throws BackendUnavailable where there is none.
class DeviceScope {
 public:
  DeviceScope();
  ~DeviceScope();
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_, used_;
};

// The pool from which device arrays are taken.
cudaMemPool_t current_memory_pool();

}  // namespace vdwmesh
