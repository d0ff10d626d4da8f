// Looks for devices that this build can use, opens one of them, and handles the memory pools. A
// device is usable if its compute capability is new enough, if it supports memory pools, if its
// compute mode lets programs use it, and if the build has machine code for it or PTX (code for a
// virtual architecture) that its driver can compile. Whether a usable device opens is known only
// when that is tried: one in exclusive mode may belong to another process by then, and another's
// memory may be full.
//
// Device arrays come from pools of the backend's own, one for each device, so that nothing that the
// backend keeps or trims is memory of another library in the process. A pool keeps what is given
// back to it until release_cuda_memory() trims it.
//
// Compute capabilities are written as 10 x the version: 80 is 8.0. After a CUDA call that may fail,
// cudaGetLastError() clears the error that the runtime has noted, so that check_launch() does not
// find it later.
#include <algorithm>
#include <array>
#include <map>
#include <mutex>
#include <string>

#include "cuda/cuda_backend.hpp"
#include "cuda/memory/check.hpp"
#include "cuda/memory/device.cuh"

namespace vdwmesh {
namespace {

// The architectures that this file is compiled for, rising. nvcc gives them as 100 x compute
// capability: 900 is 9.0.
constexpr int kArchitectures[] = {__CUDA_ARCH_LIST__};
constexpr int kLeastCapability = kArchitectures[0] / 10;  // 80 is 8.0

std::string capability_name(int capability) {
  return std::to_string(capability / 10) + "." + std::to_string(capability % 10);
}

// CUDA gives versions as 1000 * major + 10 * minor: 12040 is 12.4.
std::string version_name(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

int attribute(cudaDeviceAttr which, int device) {
  int value = 0;
  check_cuda(cudaDeviceGetAttribute(&value, which, device), "device properties");
  return value;
}

int current_device() {
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  return device;
}

// Makes a device current whether it opens or not. An error is not left for check_launch().
void make_current(int device) {
  if (cudaSetDevice(device) != cudaSuccess) cudaGetLastError();
}

// Its destructor makes the device current again that was current when it was made.
class RestoredDevice {
 public:
  RestoredDevice() : before_(current_device()) {}
  ~RestoredDevice() { make_current(before_); }
  RestoredDevice(const RestoredDevice&) = delete;
  RestoredDevice& operator=(const RestoredDevice&) = delete;

 private:
  int before_;
};

// Only for the question to the driver in has_code().
__global__ void any_kernel() {}

// Whether this build has code that runs on the device. Machine code runs on its own architecture
// and on later ones of the same major version; any other device needs PTX. kArchitectures does not
// say whether the build has PTX, so the driver is asked: it can describe any_kernel only if it has
// code for it. The driver is asked only if the list gives no answer, since the question starts a
// context on the device.
bool has_code(int device, int capability) {
  for (const int architecture : kArchitectures) {
    const int compiled = architecture / 10;
    if (compiled / 10 == capability / 10 && compiled <= capability) return true;
  }
  const RestoredDevice restored;
  cudaFuncAttributes attributes{};
  // A device that does not open is said to do so when it is used.
  if (cudaSetDevice(device) != cudaSuccess) {
    cudaGetLastError();
    return true;
  }
  if (cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(&any_kernel)) ==
      cudaSuccess) {
    return true;
  }
  cudaGetLastError();
  return false;
}

// Why this build cannot use the device; empty if it can.
std::string obstacle(int device) {
  const int capability = 10 * attribute(cudaDevAttrComputeCapabilityMajor, device) +
                         attribute(cudaDevAttrComputeCapabilityMinor, device);
  if (capability < kLeastCapability) {
    return "compute capability " + capability_name(capability) + ", this build needs " +
           capability_name(kLeastCapability) + " or later";
  }
  if (attribute(cudaDevAttrMemoryPoolsSupported, device) == 0) return "no memory pools";
  if (attribute(cudaDevAttrComputeMode, device) == cudaComputeModeProhibited) {
    return "its compute mode lets no program use it";
  }
  if (!has_code(device, capability)) {
    return "compute capability " + capability_name(capability) +
           ", for which this build has no code";
  }
  return {};
}

// The number of devices that the driver shows, usable or not. If the driver is missing or fails,
// returns 0 and writes why to `reason`.
int present_devices(std::string& reason) {
  int driver = 0, count = 0;
  if (cudaDriverGetVersion(&driver) != cudaSuccess || driver == 0) {
    cudaGetLastError();
    reason = "no NVIDIA driver";
    return 0;
  }
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess) return count;
  cudaGetLastError();
  reason = cudaGetErrorString(status);
  return 0;
}

DeviceInfo describe(int device) {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, device), "device properties");
  int driver = 0;
  check_cuda(cudaDriverGetVersion(&driver), "driver version");
  return {properties.name, version_name(driver), properties.totalGlobalMem};
}

// The pools of the devices in use. Never destroyed: release_cuda_memory() may be called while the
// process ends, after static objects are destroyed.
struct MemoryPools {
  std::mutex mutex;
  std::map<int, cudaMemPool_t> of_device;
};
MemoryPools& memory_pools() {
  static auto* const all = new MemoryPools;
  return *all;
}

// The pool of the device, made by the first call. Its release threshold makes it keep all memory.
cudaMemPool_t memory_pool(int device) {
  MemoryPools& pools = memory_pools();
  const std::lock_guard lock(pools.mutex);
  const auto found = pools.of_device.find(device);
  if (found != pools.of_device.end()) return found->second;
  cudaMemPoolProps properties{};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location = {cudaMemLocationTypeDevice, device};
  cudaMemPool_t pool = nullptr;
  check_cuda(cudaMemPoolCreate(&pool, &properties), "memory pool");
  std::uint64_t threshold = ~std::uint64_t{0};
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold),
             "memory pool");
  return pools.of_device[device] = pool;
}

// Whether the error says that the device cannot be opened now, though the program does nothing
// wrong: another process has it, its memory has no room for a context, or its driver is not ready.
bool is_taken(cudaError_t status) {
  constexpr std::array kTaken = {cudaErrorDevicesUnavailable,      cudaErrorMemoryAllocation,
                                 cudaErrorDeviceUninitialized,     cudaErrorInitializationError,
                                 cudaErrorSystemNotReady,          cudaErrorSystemDriverMismatch,
                                 cudaErrorMpsConnectionFailed,     cudaErrorMpsRpcFailure,
                                 cudaErrorMpsServerNotReady,       cudaErrorMpsMaxClientsReached,
                                 cudaErrorMpsMaxConnectionsReached};
  return std::ranges::find(kTaken, status) != kTaken.end();
}

// Makes the device current, which opens it on its first use. Returns an empty string, or why the
// device does not open.
std::string open_device(int device) {
  const cudaError_t status = cudaSetDevice(device);
  if (is_taken(status)) {
    cudaGetLastError();
    return describe(device).name + " does not open: " + cudaGetErrorString(status);
  }
  check_cuda(status, "device");
  memory_pool(device);
  return {};
}

// The usable devices, `first` before all others if it is one of them.
std::vector<int> usable_devices_from(int first) {
  std::vector<int> usable = usable_devices();
  std::ranges::stable_partition(usable, [&](int device) { return device == first; });
  return usable;
}

}  // namespace

std::vector<int> usable_devices() {
  std::string reason;
  std::vector<int> usable;
  const int count = present_devices(reason);
  for (int device = 0; device < count; ++device) {
    if (obstacle(device).empty()) usable.push_back(device);
  }
  return usable;
}

DeviceList find_cuda_devices() {
  DeviceList list;
  std::string reason;
  const int count = present_devices(reason);
  for (int device = 0; device < count; ++device) {
    const std::string why_not = obstacle(device);
    // The reason names the first device that cannot be used.
    if (why_not.empty()) {
      list.devices.push_back(describe(device));
    } else if (reason.empty()) {
      reason = describe(device).name + ": " + why_not;
    }
  }
  if (list.devices.empty()) {
    list.reason = "no CUDA device (" + (reason.empty() ? "none found" : reason) + ")";
  }
  return list;
}

void share_cuda_devices(std::size_t process) {
  const std::vector<int> usable = usable_devices();
  // If the device does not open, the calls that need one say so.
  if (!usable.empty()) open_device(usable[process % usable.size()]);
}

void use_device(int device) {
  const std::string obstacle = open_device(device);
  if (!obstacle.empty()) throw BackendUnavailable(obstacle);
}

DeviceScope::DeviceScope() : before_(current_device()) {
  std::string reason;
  for (const int device : usable_devices_from(before_)) {
    const std::string obstacle = open_device(device);
    if (obstacle.empty()) return;
    reason += (reason.empty() ? "no CUDA device (" : "; ") + obstacle;
  }
  make_current(before_);
  throw BackendUnavailable(reason.empty() ? find_cuda_devices().reason : reason + ")");
}

DeviceScope::DeviceScope(int device) : before_(current_device()) {
  if (const std::vector<int> usable = usable_devices();
      std::ranges::find(usable, device) == usable.end()) {
    throw BackendUnavailable("CUDA device " + std::to_string(device) +
                             " cannot be used by this build");
  }
  const std::string obstacle = open_device(device);
  if (obstacle.empty()) return;
  make_current(before_);
  throw BackendUnavailable(obstacle);
}

// Workers on other devices may have made these current.
DeviceScope::~DeviceScope() { make_current(before_); }

QuietDeviceScope::QuietDeviceScope(int device) noexcept {
  cudaGetDevice(&before_);
  make_current(device);
}

QuietDeviceScope::~QuietDeviceScope() { make_current(before_); }

unsigned multiprocessors() {
  int count = 0;
  check_cuda(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, current_device()),
             "device");
  return static_cast<unsigned>(count);
}

bool reads_pageable_memory() {
  return attribute(cudaDevAttrPageableMemoryAccess, current_device()) != 0;
}

cudaMemPool_t current_memory_pool() { return memory_pool(current_device()); }

void release_cuda_memory() {
  MemoryPools& pools = memory_pools();
  const std::lock_guard lock(pools.mutex);
  if (pools.of_device.empty()) return;
  const RestoredDevice restored;
  for (const auto& [device, pool] : pools.of_device) {
    check_cuda(cudaSetDevice(device), "device");
    check_cuda(cudaDeviceSynchronize(), "waiting for the device");
    check_cuda(cudaMemPoolTrimTo(pool, 0), "memory pool");
  }
}

}  // namespace vdwmesh
