// Backends, and the devices that this build can use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vdwmesh {

// automatic: CUDA on a machine with a usable device, else the CPU.
enum class Backend { automatic, cpu, cuda };

struct DeviceInfo {
  std::string name;
  std::string driver;        // CUDA driver version, "13.0"
  std::uint64_t memory = 0;  // bytes
};

// The CUDA devices that this build can use: it has code for them, they have memory pools, and their
// compute mode lets programs use them. If there is none, or if the build is without CUDA, the list
// is empty and `reason` says why.
struct DeviceList {
  std::vector<DeviceInfo> devices;
  std::string reason;
};
DeviceList cuda_devices();

// Replaces `automatic` by cuda if a device is present, else by cpu; returns the others as they are.
// Throws BackendUnavailable for cuda if no device is present; the message says what is missing.
Backend resolve(Backend requested);

// For processes that share the devices of a host: makes the usable device with number `process`,
// modulo their number, current on the calling thread, so that objects of cuda/backend.hpp compute
// on it. Does nothing if there is none.
void share_devices(std::size_t process);

// Where the backend is chosen by itself: so many balls or more are worth starting a device for
// exact measures. To begin with a device takes 0.2 s, in which 16 cores measure about so many atoms
// at 1.4 Å.
inline constexpr std::size_t kBallsWorthADevice = 500'000;

// The same for distances: meshes of so many triangles or more. In 0.2 s, 16 cores measure about so
// many both ways with the samples that they have by default.
inline constexpr std::size_t kTrianglesWorthADevice = 1'000'000;

// The same for crease-exact meshes: sets of so many spheres or more. A device takes the patches,
// but not the arrangement, and what it saves must exceed its beginning.
inline constexpr std::size_t kSpheresWorthADevice = 100'000;

// The CUDA backend keeps device memory between calls for the next call. This gives it back, after
// all work on the devices has ended, so that the process can use a device for something else, such
// as drawing. The memory is in pools of the backend's own, one for each device. Throws CudaError.
void release_device_memory();

}  // namespace vdwmesh
