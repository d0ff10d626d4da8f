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

// CUDA devices present; empty without a device or without CUDA in the build. `reason` says why.
struct DeviceList {
  std::vector<DeviceInfo> devices;
  std::string reason;
};
DeviceList cuda_devices();

// automatic -> cuda where a device is present, else cpu; the others stand. Throws
// BackendUnavailable for cuda where there is none, saying what is missing.
Backend resolve(Backend requested);

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
// `refine` is that of the extraction, whatever it says. The CUDA pipeline keeps everything on the
// device in between. The automatic one leaves to the CPU what does not fit the device's memory,
// the refinement or all of it, where the CUDA one throws DeviceMemoryExceeded. `extract.on_size`
// hears of the mesh that comes out: before it is brought from a device, after the CPU refined it.
// Where the CPU takes over from a device it may hear so twice.
class SurfacePipeline {
 public:
  virtual ~SurfacePipeline() = default;
  virtual PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                             const RefineOptions& refine) const = 0;
};
std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend);

}  // namespace vdwmesh
