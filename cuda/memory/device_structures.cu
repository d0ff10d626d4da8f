// Copies cell lists to a device, allocates the arrays of meshes there, and copies meshes there and
// back to the host. Also says how much memory of the device is left.
#include <algorithm>
#include <string>

#include "cuda/memory/device.cuh"
#include "cuda/memory/device_structures.cuh"
#include "cuda/memory/transfer.cuh"

namespace vdwmesh {

DeviceCellList::DeviceCellList(const CellListView& host, cudaStream_t stream)
    : spheres_(upload(host.spheres.data(), host.size, stream)),
      rank_(upload(host.rank.data(), host.size, stream)),
      id_(upload(host.id.data(), host.size, stream)),
      view_(host) {
  for (int l = 0; l < host.level_count; ++l) {
    const CellListView::Level& level = host.levels[l];
    const std::size_t cells = static_cast<std::size_t>(level.cells[0]) *
                              static_cast<std::size_t>(level.cells[1]) *
                              static_cast<std::size_t>(level.cells[2]);
    cell_start_.push_back(upload(level.cell_start, cells + 1, stream));
    view_.levels[l].cell_start = cell_start_.back().data();
  }
  view_.spheres = spheres_.data();
  view_.rank = rank_.data();
  view_.id = id_.data();
}

DeviceCellList::DeviceCellList(DeviceArray<Sphere> spheres, DeviceArray<Rank> rank,
                               DeviceArray<SphereId> id, DeviceArray<std::uint32_t> cell_start,
                               const CellListView& view)
    : spheres_(std::move(spheres)), rank_(std::move(rank)), id_(std::move(id)), view_(view) {
  cell_start_.push_back(std::move(cell_start));
}

DeviceMesh::DeviceMesh(std::uint64_t vertices, std::uint64_t triangles, cudaStream_t stream,
                       LabelWidth width, Normals with_normals, Connectivity connectivity)
    : positions(vertices, stream),
      normals(with_normals == Normals::gradients ? vertices : 0, stream),
      vertex_spheres{DeviceArray<SphereId>(width == LabelWidth::none ? 0 : vertices, stream),
                     DeviceArray<OtherSpheres>(width == LabelWidth::three ? vertices : 0, stream)},
      corners(3 * triangles, stream),
      opposite(connectivity == Connectivity::half_edges ? 3 * triangles : 0, stream) {}

DeviceMeshView DeviceMesh::view() const {
  return {positions.data(), normals.data(), vertex_spheres.view(), corners.data(),
          opposite.data(),  vertex_count(), triangle_count(),      triangle_spheres.data()};
}

void DeviceMesh::give_back_on(cudaStream_t stream) {
  positions.give_back_on(stream);
  normals.give_back_on(stream);
  vertex_spheres.atoms.give_back_on(stream);
  vertex_spheres.others.give_back_on(stream);
  corners.give_back_on(stream);
  opposite.give_back_on(stream);
  triangle_spheres.give_back_on(stream);
}

DeviceMesh upload_mesh(const IndexedMesh& host, const Stream& stream) {
  DeviceMesh mesh;
  std::vector<UploadPart> parts;
  const auto add = [&]<class T>(DeviceArray<T>& to, const void* from, std::size_t size) {
    to = DeviceArray<T>(size, stream.get());
    parts.push_back({to.data(), from, to.bytes()});
  };
  const VertexLabels& labels = host.vertex_spheres;
  add(mesh.positions, host.positions.data(), host.positions.size());
  add(mesh.normals, host.normals.data(), host.normals.size());
  add(mesh.vertex_spheres.atoms, labels.atoms.data(), labels.atoms.size());
  add(mesh.vertex_spheres.others, labels.others.data(), labels.others.size());
  add(mesh.corners, host.triangles.data(), 3 * host.triangles.size());
  add(mesh.triangle_spheres, host.triangle_spheres.data(), host.triangle_spheres.size());
  add(mesh.opposite, host.opposite.data(), host.opposite.size());
  upload_parts(parts, stream);
  return mesh;
}

void download_into(IndexedMesh& host, const DeviceMeshView& mesh, Connectivity connectivity,
                   const Stream& stream) {
  make_room(
      host, {mesh.vertices, mesh.triangles},
      {.connectivity = connectivity,
       .labels = mesh.triangle_spheres != nullptr ? TriangleLabels::spheres : TriangleLabels::none,
       .normals = mesh.normals != nullptr ? Normals::gradients : Normals::none,
       .width = mesh.vertex_spheres.width()});
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const auto part = [](auto& to, const void* from) {
    return DownloadPart{to.data(), from, to.size() * sizeof(to[0])};
  };
  download_parts(
      {part(host.positions, mesh.positions), part(host.normals, mesh.normals),
       part(host.vertex_spheres.atoms, mesh.vertex_spheres.atoms),
       part(host.vertex_spheres.others, mesh.vertex_spheres.others),
       part(host.triangles, mesh.corners), part(host.triangle_spheres, mesh.triangle_spheres),
       part(host.opposite, mesh.opposite)},
      stream);
}

std::uint64_t spare_device_memory() {
  const cudaMemPool_t pool = current_memory_pool();
  std::uint64_t reserved = 0, used = 0;
  check_cuda(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &reserved), "pool");
  check_cuda(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used), "pool");
  return reserved - used;
}

std::uint64_t available_device_memory() {
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "device memory");
  return free + spare_device_memory();
}

void require_device_memory(std::uint64_t bytes, const char* what, std::uint64_t allowed) {
  // The pool answers at once, the driver takes as long as a small extraction. So the driver is
  // asked only if the memory that the pool keeps does not suffice.
  if (bytes <= std::min(allowed, spare_device_memory())) return;
  const std::uint64_t available = std::min(allowed, available_device_memory());
  if (bytes <= available) return;
  throw DeviceMemoryExceeded(std::string(what) + " needs " + std::to_string(bytes) +
                             " bytes of device memory, " + std::to_string(available) +
                             " are available: choose a coarser mesh or the cpu backend");
}

}  // namespace vdwmesh
