// What computes on the backend that is asked for (cuda/backend_choice.hpp).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "analysis/distance_measurer.hpp"
#include "core/buffer.hpp"
#include "creases/exact_mesher.hpp"
#include "cuda/backend_choice.hpp"
#include "excluded/excluded_measurer.hpp"
#include "extract/batch_extractor.hpp"
#include "extract/extractor.hpp"
#include "extract/sampled_field.hpp"
#include "measures/union_measurer.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

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
