// Which CUDA devices there are.
#include "cuda/check.hpp"
#include "cuda/cuda_backend.hpp"

namespace vdwmesh {
namespace {

std::string version_name(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

}  // namespace

DeviceList find_cuda_devices() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0) {
    cudaGetLastError();
    const std::string why = status == cudaSuccess ? "none found" : cudaGetErrorString(status);
    return {{}, "no CUDA device (" + why + ")"};
  }
  int driver = 0;
  check_cuda(cudaDriverGetVersion(&driver), "driver version");
  DeviceList list;
  for (int device = 0; device < count; ++device) {
    cudaDeviceProp properties{};
    check_cuda(cudaGetDeviceProperties(&properties, device), "device properties");
    list.devices.push_back({properties.name, version_name(driver), properties.totalGlobalMem});
  }
  return list;
}

}  // namespace vdwmesh
