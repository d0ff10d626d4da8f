#include "cuda/fake_runtime.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace vdwmesh::testing {

FakeRuntime& fake_runtime() {
  static FakeRuntime runtime;
  return runtime;
}

namespace {

cudaError_t outcome(const char* function) {
  FakeRuntime& runtime = fake_runtime();
  const auto found = runtime.failures.find(function);
  if (found == runtime.failures.end()) return cudaSuccess;
  FakeRuntime::Failure& failure = found->second;
  if (failure.after-- > 0) return cudaSuccess;
  if (failure.times-- <= 0) return cudaSuccess;
  return runtime.last_error = failure.error;
}

FakeDevice& device(int number) {
  return fake_runtime().devices.at(static_cast<std::size_t>(number));
}

// A pool is known by its device.
cudaMemPool_t pool_of(int number) {
  return reinterpret_cast<cudaMemPool_t>(static_cast<std::uintptr_t>(number) + 1);
}
FakeDevice& device_of(cudaMemPool_t pool) {
  return device(static_cast<int>(reinterpret_cast<std::uintptr_t>(pool)) - 1);
}

}  // namespace
}  // namespace vdwmesh::testing

using vdwmesh::testing::device;
using vdwmesh::testing::device_of;
using vdwmesh::testing::fake_runtime;
using vdwmesh::testing::FakeDevice;
using vdwmesh::testing::FakeRuntime;
using vdwmesh::testing::outcome;
using vdwmesh::testing::pool_of;

cudaError_t cudaGetLastError() { return std::exchange(fake_runtime().last_error, cudaSuccess); }

cudaError_t cudaDriverGetVersion(int* version) {
  *version = fake_runtime().driver;
  return outcome("cudaDriverGetVersion");
}

cudaError_t cudaGetDeviceCount(int* count) {
  *count = static_cast<int>(fake_runtime().devices.size());
  if (*count == 0) return fake_runtime().last_error = cudaErrorNoDevice;
  return outcome("cudaGetDeviceCount");
}

cudaError_t cudaGetDevice(int* number) {
  *number = fake_runtime().current;
  return outcome("cudaGetDevice");
}

cudaError_t cudaSetDevice(int number) {
  // The real function makes the device current also if it does not open.
  FakeRuntime& runtime = fake_runtime();
  runtime.current = number;
  const auto n = static_cast<std::size_t>(number);
  if (n < runtime.devices.size() && runtime.devices[n].opens != cudaSuccess) {
    return runtime.last_error = runtime.devices[n].opens;
  }
  return outcome("cudaSetDevice");
}

cudaError_t cudaDeviceSynchronize() { return outcome("cudaDeviceSynchronize"); }

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr which, int number) {
  const FakeDevice& d = device(number);
  if (which == cudaDevAttrComputeCapabilityMajor) *value = d.capability / 10;
  if (which == cudaDevAttrComputeCapabilityMinor) *value = d.capability % 10;
  if (which == cudaDevAttrMemoryPoolsSupported) *value = d.has_pools ? 1 : 0;
  if (which == cudaDevAttrComputeMode) *value = d.mode;
  if (which == cudaDevAttrPageableMemoryAccess) *value = d.reads_pageable_memory ? 1 : 0;
  return outcome("cudaDeviceGetAttribute");
}

cudaError_t cudaFuncGetAttributes(cudaFuncAttributes*, const void*) {
  FakeRuntime& runtime = fake_runtime();
  if (!device(runtime.current).runs_ptx) {
    return runtime.last_error = cudaErrorNoKernelImageForDevice;
  }
  return outcome("cudaFuncGetAttributes");
}

cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int number) {
  *properties = {};
  std::snprintf(properties->name, sizeof properties->name, "%s", device(number).name.c_str());
  return outcome("cudaGetDeviceProperties");
}

cudaError_t cudaMemPoolCreate(cudaMemPool_t* pool, const cudaMemPoolProps* properties) {
  *pool = pool_of(properties->location.id);
  return outcome("cudaMemPoolCreate");
}

cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t pool, cudaMemPoolAttr, void* value) {
  FakeDevice& d = device_of(pool);
  d.keeps = *static_cast<const std::uint64_t*>(value);
  ++d.thresholds_set;
  return outcome("cudaMemPoolSetAttribute");
}

// Nothing is kept in pools, and there is no end to the memory beside them.
cudaError_t cudaMemPoolGetAttribute(cudaMemPool_t, cudaMemPoolAttr, void* value) {
  *static_cast<std::uint64_t*>(value) = 0;
  return outcome("cudaMemPoolGetAttribute");
}

cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
  *free = *total = std::size_t{1} << 40;
  return outcome("cudaMemGetInfo");
}

cudaError_t cudaMemPoolTrimTo(cudaMemPool_t pool, std::size_t) {
  ++device_of(pool).trims;
  return outcome("cudaMemPoolTrimTo");
}

cudaError_t cudaMallocFromPoolAsync(void** memory, std::size_t bytes, cudaMemPool_t, cudaStream_t) {
  const cudaError_t status = outcome("cudaMallocFromPoolAsync");
  if (status != cudaSuccess) return status;
  *memory = std::malloc(bytes);
  ++fake_runtime().allocated;
  return cudaSuccess;
}

cudaError_t cudaFreeAsync(void* memory, cudaStream_t) {
  std::free(memory);
  --fake_runtime().allocated;
  return outcome("cudaFreeAsync");
}

cudaError_t cudaHostAlloc(void** memory, std::size_t bytes, unsigned) {
  *memory = nullptr;
  const cudaError_t status = outcome("cudaHostAlloc");
  if (status != cudaSuccess) return status;
  *memory = std::malloc(bytes);
  ++fake_runtime().locked;
  return cudaSuccess;
}

cudaError_t cudaFreeHost(void* memory) {
  std::free(memory);
  --fake_runtime().locked;
  return outcome("cudaFreeHost");
}

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned) {
  *stream = nullptr;
  return outcome("cudaStreamCreateWithFlags");
}

cudaError_t cudaStreamDestroy(cudaStream_t) { return outcome("cudaStreamDestroy"); }

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind,
                            cudaStream_t) {
  std::memcpy(to, from, bytes);
  return outcome("cudaMemcpyAsync");
}

cudaError_t cudaMemsetAsync(void* memory, int value, std::size_t bytes, cudaStream_t) {
  std::memset(memory, value, bytes);
  return outcome("cudaMemsetAsync");
}

cudaError_t cudaStreamWaitEvent(cudaStream_t, cudaEvent_t, unsigned) {
  return outcome("cudaStreamWaitEvent");
}

cudaError_t cudaStreamSynchronize(cudaStream_t) {
  ++fake_runtime().stream_waits;
  return outcome("cudaStreamSynchronize");
}

cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  const cudaError_t status = outcome("cudaEventCreateWithFlags");
  if (status != cudaSuccess) return status;
  *event = reinterpret_cast<cudaEvent_t>(static_cast<std::uintptr_t>(++fake_runtime().events));
  return cudaSuccess;
}

cudaError_t cudaEventDestroy(cudaEvent_t) {
  --fake_runtime().events;
  return outcome("cudaEventDestroy");
}

cudaError_t cudaEventSynchronize(cudaEvent_t) { return outcome("cudaEventSynchronize"); }

cudaError_t cudaEventRecord(cudaEvent_t, cudaStream_t) { return outcome("cudaEventRecord"); }
