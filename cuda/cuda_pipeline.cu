// Extraction and refinement on one CUDA device. The mesh stays there in between. Two entries share
// the steps: the pipeline of backend.cpp, whose spheres are on the host and whose mesh is
// downloaded, and mesh_on_device(), for which both are on the device.
#include <utility>

#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/memory/device_mesh.cuh"
#include "cuda/on_device.hpp"
#include "cuda/refine/device_refinement.cuh"
#include "cuda/spheres/device_frames.cuh"
#include "refine/crossings/preparation.hpp"

namespace vdwmesh {

namespace {

// The spheres of a run as its stages need them, on the host or on the device.
class HostSpheres {
 public:
  HostSpheres(const SphereSet& spheres, const CellListFrame* frame, Workspace& workspace,
              const Stream& stream)
      : spheres_(spheres), frame_(frame), workspace_(workspace), stream_(stream) {}

  std::size_t size() const { return spheres_.size(); }
  const Stream& stream() const { return stream_; }
  DeviceCellList list(const FieldModel& model) const {
    return upload_list(prepare_list(spheres_, model, frame_, workspace_), model, stream_);
  }
  DeviceSurface surface(const RefineOptions& options) const {
    return {spheres_, options, TriangleLabels::none, workspace_, stream_};
  }

 private:
  const SphereSet& spheres_;
  const CellListFrame* frame_;
  Workspace& workspace_;
  const Stream& stream_;
};

class SpheresOnDevice {
 public:
  explicit SpheresOnDevice(const DeviceFrames::Data& balls) : balls_(balls) {}

  std::size_t size() const { return balls_.atoms; }
  const Stream& stream() const { return balls_.work(); }
  DeviceCellList list(const FieldModel& model) const { return build_cell_list(balls_, model); }
  DeviceSurface surface(const RefineOptions& options) const {
    return {balls_, options, TriangleLabels::none};
  }

 private:
  const DeviceFrames::Data& balls_;
};

// In a function of its own, so that the cell list of the extraction leaves the device before the
// refinement.
template <class Spheres>
DeviceExtraction extract(const Spheres& spheres, const GridSpec& grid,
                         const ExtractOptions& options) {
  const FieldModel model = make_field_model(options.field, grid);
  const DeviceCellList list = spheres.list(model);
  return extract_on_device(list.view(), model, options, spheres.stream());
}

// The surface is on the grid of `options`.
template <class Spheres>
DeviceRefinement refine(const Spheres& spheres, DeviceMesh mesh, const RefineOptions& options) {
  check_refinement_size(spheres.size(), mesh.vertex_count(), mesh.triangle_count(), options);
  begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
  const DeviceSurface surface = spheres.surface(options);
  return refine_on_device(surface.view(), std::move(mesh), options, spheres.stream());
}

ExtractOptions with_half_edges(const ExtractOptions& options) {
  ExtractOptions with = options;
  with.connectivity = Connectivity::half_edges;
  return with;
}

RefineOptions on_grid(const RefineOptions& options, const GridSpec& grid) {
  RefineOptions with = options;
  with.grid = grid;
  return with;
}

class OneDevicePipeline final : public SurfacePipeline {
 public:
  void run_into(PipelineResult& result, const SphereSet& spheres, const ExtractOptions& extraction,
                const RefineOptions& refinement) const override {
    const DeviceScope scope;
    WorkspaceOfCall workspace(extraction.workspace);
    const GridSpec grid = make_grid(spheres, extraction.grid);
    const Stream stream;
    const HostSpheres source(spheres, extraction.frame, workspace, stream);
    DeviceExtraction extracted = extract(source, grid, with_half_edges(extraction));
    // Levels and seconds are filled in below; there is no fallback.
    result = {std::move(result.mesh), grid, extracted.stats, {}, 0, {}};
    DeviceRefinement refined = refine(source, std::move(extracted.mesh), on_grid(refinement, grid));
    const DeviceMeshView mesh = refined.mesh.view();
    if (extraction.on_size) extraction.on_size({mesh.vertices, mesh.triangles});
    const bool has_half_edges = refined.mesh.opposite.size() > 0;
    download_into(result.mesh, mesh,
                  has_half_edges ? Connectivity::half_edges : Connectivity::triangles, stream);
    result.levels = std::move(refined.levels);
    for (const float ms : refined.level_milliseconds) result.refine_seconds += ms * 1e-3;
  }
};

// The extracted mesh, refined if there is a subdivision.
DeviceMesh run_on_device(const DeviceFrames& spheres, const ExtractOptions& extraction,
                         const RefineOptions& refinement) {
  const SpheresOnDevice source(spheres.data());
  const GridSpec grid = make_grid(spheres.balls(), spheres.centers(), extraction.grid);
  if (refinement.subdivisions == 0) return extract(source, grid, extraction).mesh;
  DeviceMesh mesh = extract(source, grid, with_half_edges(extraction)).mesh;
  return refine(source, std::move(mesh), on_grid(refinement, grid)).mesh;
}

}  // namespace

std::unique_ptr<SurfacePipeline> make_cuda_pipeline() {
  return std::make_unique<OneDevicePipeline>();
}

CudaMesh mesh_on_device(const DeviceFrames& spheres, const ExtractOptions& extract,
                        const RefineOptions& refine) {
  if (spheres.valid_frames() == 0) throw InvalidFrame(*spheres.invalid());
  const int device = spheres.data().device;
  const DeviceScope scope(device);
  DeviceMesh mesh = run_on_device(spheres, extract, refine);
  spheres.data().work().wait();
  return kept_mesh(device, std::move(mesh));
}

}  // namespace vdwmesh
