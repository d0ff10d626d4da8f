// The CUDA devices that this build can use, and the one that a call works on.
#pragma once

#include <cuda_runtime.h>

#include <vector>

namespace vdwmesh {

// CUDA's numbers, rising, of the devices that this build can use: it has code for them, they have
// memory pools, and their compute mode lets programs use them. Another process may have taken one.
std::vector<int> usable_devices();

// Makes the device current on this thread. Throws BackendUnavailable if the device cannot be
// opened, since another process has it or has filled its memory.
void use_device(int device);

// While the object lives, a usable device is current on this thread: the device that was current
// before if it is usable and opens, else the first one that does. Afterwards the former device is
// current again. Throws BackendUnavailable if no usable device opens. With a number, that device is
// current; the constructor throws BackendUnavailable if it is not usable or does not open.
class DeviceScope {
 public:
  DeviceScope();
  explicit DeviceScope(int device);
  ~DeviceScope();
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_;
};

// While the object lives, the device is current on this thread, unless CUDA refuses. For
// destructors: it throws nothing and checks nothing, because the driver may be gone already.
class QuietDeviceScope {
 public:
  explicit QuietDeviceScope(int device) noexcept;
  ~QuietDeviceScope();
  QuietDeviceScope(const QuietDeviceScope&) = delete;
  QuietDeviceScope& operator=(const QuietDeviceScope&) = delete;

 private:
  int before_ = 0;
};

// How many multiprocessors the current device has.
unsigned multiprocessors();

// Whether the current device reads memory of the host whose pages are not locked.
bool reads_pageable_memory();

// The backend's own memory pool of the current device, from which device arrays are taken. It keeps
// what is given back, so that later allocations do not wait for the driver. release_device_memory()
// (backend.hpp) frees what it keeps.
cudaMemPool_t current_memory_pool();

}  // namespace vdwmesh
