#include <cstring>

#include "cuda/device_structures.cuh"

namespace vdwmesh {
namespace {

template <class T>
void copy_down(T* host, const DeviceArray<T>& device, const Stream& stream) {
  if (device.size() == 0) return;
  check_cuda(
      cudaMemcpyAsync(host, device.data(), device.bytes(), cudaMemcpyDeviceToHost, stream.get()),
      "download");
}

// Page-locks an array for the length of a copy: pinned copies run at the bus's full rate.
class PinnedRange {
 public:
  PinnedRange(void* data, std::size_t bytes) {
    if (bytes > 0 && cudaHostRegister(data, bytes, cudaHostRegisterDefault) == cudaSuccess) {
      data_ = data;
    }
    cudaGetLastError();  // not pinned: the copy is slower, and as right
  }
  ~PinnedRange() {
    if (data_) cudaHostUnregister(data_);
  }
  PinnedRange(const PinnedRange&) = delete;
  PinnedRange& operator=(const PinnedRange&) = delete;

 private:
  void* data_ = nullptr;
};

}  // namespace

DeviceCellList::DeviceCellList(const CellListView& host, cudaStream_t stream)
    : spheres_(upload(host.spheres, host.size, stream)),
      rank_(upload(host.rank, host.size, stream)),
      id_(upload(host.id, host.size, stream)),
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

DeviceMesh::DeviceMesh(std::uint64_t vertices, std::uint64_t triangles, cudaStream_t stream,
                       DeviceLabels labels, DeviceNormals with_normals)
    : positions(vertices, stream),
      normals(with_normals == DeviceNormals::gradients ? vertices : 0, stream),
      vertex_spheres(labels == DeviceLabels::spheres ? vertices : 0, stream),
      corners(3 * triangles, stream),
      opposite(3 * triangles, stream) {}

DeviceMeshView DeviceMesh::view() const {
  return {positions.data(), normals.data(), vertex_spheres.data(), corners.data(),
          opposite.data(),  vertex_count(), triangle_count(),      triangle_spheres.data()};
}

IndexedMesh download(const DeviceMesh& mesh, Connectivity connectivity, const Stream& stream) {
  IndexedMesh host;
  host.positions.resize(mesh.vertex_count());
  host.normals.resize(mesh.normals.size());
  host.vertex_spheres.resize(mesh.vertex_spheres.size());
  host.triangles.resize(mesh.triangle_count());
  host.triangle_spheres.resize(mesh.triangle_spheres.size());
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  auto* corners = reinterpret_cast<std::uint32_t*>(host.triangles.data());
  const PinnedRange pin_positions(host.positions.data(), mesh.positions.bytes());
  const PinnedRange pin_normals(host.normals.data(), mesh.normals.bytes());
  const PinnedRange pin_spheres(host.vertex_spheres.data(), mesh.vertex_spheres.bytes());
  const PinnedRange pin_corners(corners, mesh.corners.bytes());
  copy_down(host.positions.data(), mesh.positions, stream);
  copy_down(host.normals.data(), mesh.normals, stream);
  copy_down(host.vertex_spheres.data(), mesh.vertex_spheres, stream);
  copy_down(corners, mesh.corners, stream);
  copy_down(host.triangle_spheres.data(), mesh.triangle_spheres, stream);
  if (connectivity == Connectivity::half_edges) {
    host.opposite.resize(mesh.opposite.size());
    copy_down(host.opposite.data(), mesh.opposite, stream);
  }
  stream.wait();
  return host;
}

namespace {

// Bytes that the pool holds and nobody uses.
std::uint64_t spare_in_pool() {
  cudaMemPool_t pool = nullptr;
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "memory pool");
  std::uint64_t reserved = 0, used = 0;
  check_cuda(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrReservedMemCurrent, &reserved), "pool");
  check_cuda(cudaMemPoolGetAttribute(pool, cudaMemPoolAttrUsedMemCurrent, &used), "pool");
  return reserved - used;
}

}  // namespace

std::uint64_t available_device_memory() {
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "device memory");
  return free + spare_in_pool();
}

void require_device_memory(std::uint64_t bytes, const char* what) {
  // The pool answers at once; the driver takes as long as a small extraction.
  if (bytes <= spare_in_pool()) return;
  const std::uint64_t available = available_device_memory();
  if (bytes <= available) return;
  throw LimitExceeded(std::string(what) + " needs " + std::to_string(bytes) +
                      " bytes of device memory, " + std::to_string(available) +
                      " are available: choose a larger spacing or the cpu backend");
}

void keep_device_memory() {
  cudaMemPool_t pool = nullptr;
  int device = 0;
  check_cuda(cudaGetDevice(&device), "device");
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, device), "memory pool");
  std::uint64_t threshold = ~std::uint64_t{0};
  check_cuda(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &threshold), "pool");
}

}  // namespace vdwmesh
