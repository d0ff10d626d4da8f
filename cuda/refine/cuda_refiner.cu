// The CUDA backend of Refiner: checks the arguments as the CPU backend does, uploads the mesh and
// the spheres, finds half-edges that are not given and refines in device memory
// (refine_on_device()), and downloads the result.
#include <utility>

#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/refine/device_refinement.cuh"
#include "refine/crossings/preparation.hpp"

namespace vdwmesh {

DeviceSurface::DeviceSurface(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace, const Stream& stream)
    : list_(projection_list(spheres, options, labels, workspace), stream.get()),
      spheres_(upload(spheres.spheres().data(), spheres.size(), stream.get())),
      view_{options.projection, list_.view(), projection_model(options), spheres_.data()} {}

namespace {

// The list that projection_list() makes on the host.
DeviceCellList projection_list(const DeviceFrames::Data& balls, const RefineOptions& options,
                               TriangleLabels labels) {
  const bool searches = labels == TriangleLabels::none && options.projection != Projection::none;
  if (!searches) return {CellListView{}, balls.work().get()};
  return build_cell_list(balls, projection_model(options));
}

}  // namespace

DeviceSurface::DeviceSurface(const DeviceFrames::Data& balls, const RefineOptions& options,
                             TriangleLabels labels)
    : list_(projection_list(balls, options, labels)),
      view_{options.projection, list_.view(), projection_model(options), balls.rows.data()} {}

namespace {

class CudaRefiner final : public Refiner {
 public:
  RefineResult refine(const SphereSet& spheres, IndexedMesh&& mesh,
                      const RefineOptions& options) const override {
    check_refinement(spheres, mesh, options);
    const TriangleLabels labels = mesh.triangle_labels();
    begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
    const DeviceScope scope;
    const Stream stream;
    WorkspaceOfCall workspace(options.workspace);
    const DeviceSurface surface(spheres, options, labels, workspace, stream);
    // Half-edges that are given are checked here; others are found on the device.
    mesh = mesh.opposite.empty() ? complete_labels(std::move(mesh), options)
                                 : prepare_mesh(std::move(mesh), options);
    DeviceMesh there = upload_mesh(mesh, stream);
    mesh = {};
    DeviceRefinement refined = refine_on_device(surface.view(), std::move(there), options, stream);
    RefineResult result;
    const Connectivity connectivity =
        refined.mesh.opposite.size() > 0 ? Connectivity::half_edges : Connectivity::triangles;
    result.mesh = download(refined.mesh.view(), connectivity, stream);
    result.levels = std::move(refined.levels);
    for (const float ms : refined.level_milliseconds) result.seconds += ms * 1e-3;
    return result;
  }
};

}  // namespace

std::unique_ptr<Refiner> make_cuda_refiner() { return std::make_unique<CudaRefiner>(); }

}  // namespace vdwmesh
