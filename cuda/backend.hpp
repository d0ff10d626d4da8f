// The one place where a backend is chosen.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "extract/extractor.hpp"
#include "extract/sampled_field.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

enum class Backend { automatic, cpu, cuda };

struct DeviceInfo {
  std::string name;
  std::string driver;        // CUDA driver version, "13.0"
  std::uint64_t memory = 0;  // bytes
};

// CUDA devices that this build can use: it has code for them, and they have memory pools. Empty
// where there is none, or no CUDA in the build; `reason` says why.
struct DeviceList {
  std::vector<DeviceInfo> devices;
  std::string reason;
};
DeviceList cuda_devices();

// automatic -> cuda where a device is present, else cpu; the others stand. Throws
// BackendUnavailable for cuda where there is none, saying what is missing.
Backend resolve(Backend requested);

// Gives back the device memory that the CUDA backend keeps between calls for the next one, after
// what runs on those devices has ended; for who wants to use a device for something else in the
// same process, such as drawing. The memory is that of each device's default pool
// (cudaMallocAsync), which the backend tells to keep all it has. Throws CudaError.
void release_device_memory();

// Each of these computes on the current device of the calling thread, or on the first usable one
// where that is none. The automatic ones leave to the CPU what does not fit the device's memory,
// and say so in `fallback` of what they return, where the CUDA ones throw DeviceMemoryExceeded.
std::unique_ptr<Extractor> make_extractor(Backend backend);
std::unique_ptr<Refiner> make_refiner(Backend backend);
std::unique_ptr<FieldMesher> make_field_mesher(Backend backend);

struct PipelineResult {
  IndexedMesh mesh;
  GridSpec grid;
  ExtractStats extract;
  std::vector<ProjectionStats> levels;
  double refine_seconds = 0;
  std::string fallback;  // why the CPU did a part that a device was to do; empty: it did none
};

// Extraction, then refinement; with 0 subdivisions the extracted mesh as it is. The grid of
// `refine` is that of the extraction, whatever it says. The CUDA pipeline keeps everything on one
// device in between, where that fits; else, and where `extract.devices` asks for several, it
// extracts in slabs to the host and refines on one device what came out. The automatic one leaves
// to the CPU the refinement or all of it where that does not fit either. `extract.on_size` hears of
// the mesh that comes out: before it is brought from a device, or after it was refined. Where a
// second way is taken it may hear so twice.
class SurfacePipeline {
 public:
  virtual ~SurfacePipeline() = default;
  virtual PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                             const RefineOptions& refine) const = 0;
};
std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend);

}  // namespace vdwmesh
