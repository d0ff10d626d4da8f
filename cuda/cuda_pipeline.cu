// Extraction and refinement on one CUDA device. The mesh stays there in between, so that only the
// refined mesh is downloaded. backend.cpp uses this pipeline if both stages fit on the device
// together.
#include <utility>

#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/refine/device_refinement.cuh"
#include "extract/field_list.hpp"
#include "refine/preparation.hpp"

namespace vdwmesh {
namespace {

class OneDevicePipeline final : public SurfacePipeline {
 public:
  PipelineResult run(const SphereSet& spheres, const ExtractOptions& extract,
                     const RefineOptions& refine) const override {
    const DeviceScope scope;
    WorkspaceOfCall workspace(extract.workspace);
    const GridSpec grid = make_grid(spheres, extract.grid);
    const FieldModel model = make_field_model(extract.field, grid);
    const Stream stream;
    ExtractOptions with_half_edges = extract;
    with_half_edges.connectivity = Connectivity::half_edges;
    // In a function of its own, so that the cell list of the extraction leaves the device before
    // the refinement.
    DeviceExtraction extraction = [&] {
      const CellListView list = field_list(spheres, model, extract.frame, workspace);
      const DeviceCellList device_list(list, stream.get());
      return extract_on_device(device_list.view(), model, with_half_edges, stream);
    }();
    // The mesh, levels, seconds are filled in below; there is no fallback.
    PipelineResult result{{}, grid, extraction.stats, {}, 0, {}};
    RefineOptions options = refine;
    options.grid = grid;
    check_refinement_size(spheres.size(), extraction.mesh.vertex_count(),
                          extraction.mesh.triangle_count(), options);
    begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
    const DeviceSurface surface(spheres, options, TriangleLabels::none, workspace, stream);
    DeviceRefinement refined =
        refine_on_device(surface.view(), std::move(extraction.mesh), options, stream);
    const DeviceMeshView mesh = refined.mesh.view();
    if (extract.on_size) extract.on_size({mesh.vertices, mesh.triangles});
    const bool has_half_edges = refined.mesh.opposite.size() > 0;
    result.mesh =
        download(mesh, has_half_edges ? Connectivity::half_edges : Connectivity::triangles, stream);
    result.levels = std::move(refined.levels);
    for (const float ms : refined.level_milliseconds) result.refine_seconds += ms * 1e-3;
    return result;
  }
};

}  // namespace

std::unique_ptr<SurfacePipeline> make_cuda_pipeline() {
  return std::make_unique<OneDevicePipeline>();
}

}  // namespace vdwmesh
