// Meshes that callers keep on a device, and their way to the host.
#include "cuda/memory/device_mesh.cuh"

namespace vdwmesh {

CudaMesh::Data::Data(int on, DeviceMesh made) : DeviceResult(on, std::move(made)) {
  const DeviceMesh& mesh = arrays();
  view = {on,
          mesh.vertex_count(),
          mesh.triangle_count(),
          mesh.positions.data(),
          mesh.normals.data(),
          mesh.vertex_spheres.atoms.data(),
          mesh.triangle_spheres.data(),
          mesh.corners.data()};
}

CudaMesh kept_mesh(int device, DeviceMesh made) {
  return CudaMesh(std::make_shared<const CudaMesh::Data>(device, std::move(made)));
}

const CudaMeshArrays& CudaMesh::arrays() const { return data_->view; }

IndexedMesh CudaMesh::download() const {
  const DeviceScope scope(data_->device());
  const Stream stream;
  return vdwmesh::download(data_->arrays().view(), Connectivity::triangles, stream);
}

}  // namespace vdwmesh
