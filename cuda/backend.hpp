// The one place where a backend (CPU or CUDA) is chosen.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "analysis/distance_measurer.hpp"
#include "core/buffer.hpp"
#include "creases/exact_mesher.hpp"
#include "excluded/excluded_measurer.hpp"
#include "extract/batch_extractor.hpp"
#include "extract/extractor.hpp"
#include "extract/sampled_field.hpp"
#include "measures/union_measurer.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

// automatic: CUDA on a machine with a usable device, else the CPU.
enum class Backend { automatic, cpu, cuda };

struct DeviceInfo {
  std::string name;
  std::string driver;        // CUDA driver version, "13.0"
  std::uint64_t memory = 0;  // bytes
};

// The CUDA devices that this build can use: it has code for them, they have memory pools, and their
// compute mode lets programs use them. If
// there is none, or if the build is without CUDA, the list is empty and `reason` says why.
struct DeviceList {
  std::vector<DeviceInfo> devices;
  std::string reason;
};
DeviceList cuda_devices();

// Replaces `automatic` by cuda if a device is present, else by cpu; returns the others as they are.
// Throws BackendUnavailable for cuda if no device is present; the message says what is missing.
Backend resolve(Backend requested);

// For processes that share the devices of a host: makes the usable device with number `process`,
// modulo their number, current on the calling thread, so that what is made below computes on it.
// Does nothing if there is none.
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

// Each of these computes on the current device of the calling thread, or on the first usable device
// if that one is not usable. If the work does not fit the device's memory, the objects for cuda
// throw DeviceMemoryExceeded; if no device opens, since other processes have taken them,
// BackendUnavailable. The objects for automatic leave the work to the CPU then, and say so in the
// `fallback` of their results.
std::unique_ptr<Extractor> make_extractor(Backend backend);
std::unique_ptr<BatchExtractor> make_batch_extractor(Backend backend);
std::unique_ptr<Refiner> make_refiner(Backend backend);
std::unique_ptr<FieldMesher> make_field_mesher(Backend backend);
std::unique_ptr<UnionMeasurer> make_union_measurer(Backend backend);
std::unique_ptr<ExactMesher> make_exact_mesher(Backend backend);
std::unique_ptr<DistanceMeasurer> make_distance_measurer(Backend backend);
std::unique_ptr<ExcludedMeasurer> make_excluded_measurer(Backend backend);

// What a device measures of a set without help from the host, as ArcMeasures has it: exposed area
// and ball ∩ power cell of each sphere, and the spheres whose numbers mean nothing, ascending.
struct DeviceArcs {
  Buffer<SphereMeasures> per_sphere;  // Å², Å³
  std::vector<SphereId> suspect;
};
// On the current device of the calling thread, or on the first usable one. A sphere that is no
// suspect has the bits that it has in every set that has all balls that overlap it. Throws
// BackendUnavailable and DeviceMemoryExceeded.
DeviceArcs measure_arcs_on_device(const SphereSet& spheres);

struct PipelineResult {
  IndexedMesh mesh;
  GridSpec grid;
  ExtractStats extract;
  std::vector<ProjectionStats> levels;
  double refine_seconds = 0;
  std::string fallback;  // why the CPU did work that was meant for a device; empty if it did none
};

// Extraction, then refinement; with 0 subdivisions the result is the extracted mesh. The grid of
// the extraction replaces the grid of the options `refine`.
//
// The CUDA pipeline keeps everything on one device in between, if that fits. Otherwise, and if
// `extract.devices` asks for several devices, it extracts in slabs to the host and refines the mesh
// on one device. The automatic pipeline leaves the refinement, or all of it, to the CPU if that
// does not fit either.
//
// `extract.on_size` is called with the size of the resulting mesh: before it is downloaded from a
// device, or after it was refined. If a first attempt fails after that, the second attempt calls it
// again.
class SurfacePipeline {
 public:
  virtual ~SurfacePipeline() = default;
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const {
    PipelineResult result;
    run_into(result, spheres, extract, refine);
    return result;
  }

  // run() that replaces `result`. The extracted mesh, and any mesh that is downloaded from a
  // device, takes the memory of the arrays of result.mesh: a copy from the device into pages that
  // have been written before takes three quarters of the time. If it throws, `result` has no
  // meaning.
  virtual void run_into(PipelineResult& result, const SphereSet& spheres,
                        const ExtractOptions& extract, const RefineOptions& refine) const = 0;
};
std::unique_ptr<SurfacePipeline> make_pipeline(Backend backend);

}  // namespace vdwmesh
