// The CUDA backend of Refiner: checks the arguments as the CPU backend does, uploads the mesh and
// the spheres, refines in device memory (refine_on_device()), and downloads the result.
#include <utility>

#include "cuda/cuda_backend.hpp"
#include "cuda/memory/device.cuh"
#include "cuda/refine/device_refinement.cuh"
#include "refine/preparation.hpp"

namespace vdwmesh {

DeviceSurface::DeviceSurface(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace, const Stream& stream)
    : list_(projection_list(spheres, options, labels, workspace), stream.get()),
      spheres_(upload(spheres.spheres().data(), spheres.size(), stream.get())),
      view_{options.projection, list_.view(), projection_model(options), spheres_.data()} {}

// Builds the list of the balls or of the field, whichever projection_list() would return.
DeviceSurface::DeviceSurface(const DeviceFrames::Data& balls, const RefineOptions& options)
    : list_(build_cell_list(balls, projection_model(options))),
      view_{options.projection, list_.view(), projection_model(options), balls.rows.data()} {}

namespace {

// Copies the mesh to the device. Given normals are needed only if nothing is projected, because
// they are interpolated then. Otherwise normals are computed, and their array stays uninitialised
// here.
DeviceMesh upload_mesh(const IndexedMesh& host, Projection projection, const Stream& stream) {
  DeviceMesh mesh;
  mesh.positions = upload(host.positions.data(), host.positions.size(), stream.get());
  const VertexLabels& labels = host.vertex_spheres;
  mesh.vertex_spheres = {upload(labels.atoms.data(), labels.atoms.size(), stream.get()),
                         upload(labels.others.data(), labels.others.size(), stream.get())};
  mesh.normals = projection == Projection::none
                     ? upload(host.normals.data(), host.normals.size(), stream.get())
                     : DeviceArray<Vec3f>(host.positions.size(), stream.get());
  mesh.corners = upload(reinterpret_cast<const std::uint32_t*>(host.triangles.data()),
                        3 * host.triangles.size(), stream.get());
  mesh.triangle_spheres =
      upload(host.triangle_spheres.data(), host.triangle_spheres.size(), stream.get());
  mesh.opposite = upload(host.opposite.data(), host.opposite.size(), stream.get());
  return mesh;
}

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
    DeviceRefinement refined = refine_on_device(
        surface.view(),
        upload_mesh(prepare_mesh(std::move(mesh), options), options.projection, stream), options,
        stream);
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
