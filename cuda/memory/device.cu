// Looks for devices that this build can use, makes one of them current, and handles their memory
// pools. A device is usable if its compute capability is new enough, if it supports memory pools,
// and if the build has machine code for it or PTX (code for a virtual architecture) that its driver
// can compile. The memory pool of a device in use keeps what is given back to it until
// release_cuda_memory() trims it.
//
// Compute capabilities are written as 10 x the version: 80 is 8.0. After a CUDA call that may fail,
// cudaGetLastError() clears the error that the runtime has noted, so that check_launch() does not
// find it later.
#include <algorithm>
#include <mutex>
#include <set>
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

// Its destructor makes the device current again that was current when it was made.
class RestoredDevice {
 public:
  RestoredDevice() : before_(current_device()) {}
  ~RestoredDevice() { cudaSetDevice(before_); }
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
  check_cuda(cudaSetDevice(device), "device");
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

// The devices whose memory pools have been told to keep what is given back. Never destroyed:
// release_cuda_memory() may be called while the process ends, after static objects are destroyed.
struct KeptPools {
  std::mutex mutex;
  std::set<int> devices;
};
KeptPools& kept_pools() {
  static auto* const kept = new KeptPools;
  return *kept;
}

// Tells the pool of the current device, which is `device`, to keep all its memory; once per device.
void keep_memory(int device) {
  KeptPools& kept = kept_pools();
  const std::lock_guard lock(kept.mutex);
  if (kept.devices.contains(device)) return;
  std::uint64_t threshold = ~std::uint64_t{0};
  check_cuda(
      cudaMemPoolSetAttribute(current_memory_pool(), cudaMemPoolAttrReleaseThreshold, &threshold),
      "memory pool");
  kept.devices.insert(device);
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
  if (!usable.empty()) use_device(usable[process % usable.size()]);
}

void use_device(int device) {
  check_cuda(cudaSetDevice(device), "device");
  keep_memory(device);
}

DeviceScope::DeviceScope() : before_(current_device()), used_(before_) {
  const std::vector<int> usable = usable_devices();
  if (usable.empty()) throw BackendUnavailable(find_cuda_devices().reason);
  // The device that is current is used if it can be, else the first usable one.
  if (std::ranges::find(usable, before_) == usable.end()) used_ = usable.front();
  use_device(used_);
}

DeviceScope::DeviceScope(int device) : before_(current_device()), used_(device) {
  if (const std::vector<int> usable = usable_devices();
      std::ranges::find(usable, device) == usable.end()) {
    throw BackendUnavailable("CUDA device " + std::to_string(device) +
                             " cannot be used by this build");
  }
  use_device(device);
}

DeviceScope::~DeviceScope() {
  if (used_ != before_) cudaSetDevice(before_);
}

QuietDeviceScope::QuietDeviceScope(int device) noexcept {
  cudaGetDevice(&before_);
  cudaSetDevice(device);
}

QuietDeviceScope::~QuietDeviceScope() { cudaSetDevice(before_); }

unsigned multiprocessors() {
  int count = 0;
  check_cuda(cudaDeviceGetAttribute(&count, cudaDevAttrMultiProcessorCount, current_device()),
             "device");
  return static_cast<unsigned>(count);
}

cudaMemPool_t current_memory_pool() {
  cudaMemPool_t pool = nullptr;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, current_device()), "memory pool");
  return pool;
}

void release_cuda_memory() {
  KeptPools& kept = kept_pools();
  const std::lock_guard lock(kept.mutex);
  if (kept.devices.empty()) return;
  const RestoredDevice restored;
  for (const int device : kept.devices) {
    check_cuda(cudaSetDevice(device), "device");
    check_cuda(cudaDeviceSynchronize(), "waiting for the device");
    check_cuda(cudaMemPoolTrimTo(current_memory_pool(), 0), "memory pool");
  }
}

}  // namespace vdwmesh
