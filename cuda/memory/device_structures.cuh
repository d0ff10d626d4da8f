// The library's arrays (cell lists, labels, meshes) in device memory, and the functions that
// extract meshes into it. An owner has arrays (DeviceMesh); its view (DeviceMeshView) has pointers
// and is passed to kernels by value.
#pragma once

#include <array>
#include <vector>

#include "core/errors.hpp"
#include "cuda/memory/device_memory.cuh"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/extractor.hpp"
#include "extract/field.hpp"
#include "extract/sampled_field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// A cell list in device memory. It has the order and the list places of the CellList on the host,
// whether it was copied from there or built on the device (build_cell_list()).
class DeviceCellList {
 public:
  DeviceCellList(const CellListView& host, cudaStream_t stream);
  // Takes arrays that were filled on the device. `view` has their addresses.
  DeviceCellList(DeviceArray<Sphere> spheres, DeviceArray<Rank> rank, DeviceArray<SphereId> id,
                 DeviceArray<std::uint32_t> cell_start, const CellListView& view);
  const CellListView& view() const { return view_; }

 private:
  DeviceArray<Sphere> spheres_;
  DeviceArray<Rank> rank_;
  DeviceArray<SphereId> id_;
  std::vector<DeviceArray<std::uint32_t>> cell_start_;
  CellListView view_{};
};

// The three ids of a label as an array.
__device__ inline const SphereId* ids(const VertexSpheres& label) {
  return reinterpret_cast<const SphereId*>(&label);
}

// VertexLabels as kernels see them.
struct DeviceLabelsView {
  SphereId* atoms;       // the first sphere of each label; null if the mesh has no labels
  OtherSpheres* others;  // the second and third; null if labels have one sphere only

  LabelWidth width() const {
    if (atoms == nullptr) return LabelWidth::none;
    return others == nullptr ? LabelWidth::one : LabelWidth::three;
  }

  __device__ VertexSpheres operator[](std::uint64_t v) const {
    if (others == nullptr) return on_sphere(atoms[v]);
    const OtherSpheres more = others[v];
    const auto* const two = reinterpret_cast<const SphereId*>(&more);
    return {atoms[v], two[0], two[1]};
  }
  // Precondition: the mesh has labels. If they have one sphere only, the others of `label` are
  // dropped.
  __device__ void set(std::uint64_t v, const VertexSpheres& label) const {
    const SphereId* const id = ids(label);
    atoms[v] = id[0];
    if (others != nullptr) others[v] = {id[1], id[2]};
  }
};

// The arrays of a DeviceMesh as kernels see them. If the arrays hold only a part of a mesh, they
// begin with the vertex first_vertex and the triangle first_triangle of the whole mesh; but the
// entries of `corners` and `opposite` are numbers in the whole mesh.
struct DeviceMeshView {
  Vec3d* positions;
  Vec3f* normals;  // null without normals
  DeviceLabelsView vertex_spheres;
  std::uint32_t* corners;   // 3 per triangle
  std::uint32_t* opposite;  // 3 per triangle; null without half-edges
  std::uint64_t vertices, triangles;
  SphereId* triangle_spheres;  // null, or one per triangle
  std::uint64_t first_vertex = 0, first_triangle = 0;
};

struct DeviceVertexLabels {
  DeviceArray<SphereId> atoms;
  DeviceArray<OtherSpheres> others;  // empty, or as many as atoms

  DeviceLabelsView view() const { return {atoms.data(), others.data()}; }
};

// An IndexedMesh in device memory.
struct DeviceMesh {
  DeviceArray<Vec3d> positions;
  DeviceArray<Vec3f> normals;
  DeviceVertexLabels vertex_spheres;
  DeviceArray<std::uint32_t> corners, opposite;  // opposite: empty without half-edges
  DeviceArray<SphereId> triangle_spheres;        // empty, or one per triangle

  DeviceMesh() = default;
  DeviceMesh(std::uint64_t vertices, std::uint64_t triangles, cudaStream_t stream, LabelWidth width,
             Normals normals, Connectivity connectivity);
  std::uint64_t vertex_count() const { return positions.size(); }
  std::uint64_t triangle_count() const { return corners.size() / 3; }
  TriangleLabels triangle_labels() const {
    return triangle_spheres.size() > 0 ? TriangleLabels::spheres : TriangleLabels::none;
  }
  DeviceMeshView view() const;
  // See DeviceArray; for all arrays.
  void give_back_on(cudaStream_t stream);
};

// Milliseconds of device time that the stages of an extraction took.
struct ExtractTimings {
  float search = 0;     // finding the bricks that may hold surface
  float count = 0;      // field values, signs, marching cubes cases, counts
  float scan = 0;       // prefix sums over the counts
  float vertices = 0;   // positions, normals, labels
  float triangles = 0;  // corners and half-edges
};

struct DeviceExtraction {
  DeviceMesh mesh;
  std::uint64_t candidates = 0;  // bricks whose nodes were looked at
  ExtractStats stats;
  ExtractTimings timings;
};

// Extracts a mesh into device memory, from a cell list in device memory. Throws LimitExceeded, and
// DeviceMemoryExceeded if it would take more than options.device_memory or than is free.
DeviceExtraction extract_on_device(const CellListView& list, const FieldModel& model,
                                   const ExtractOptions& options, const Stream& stream);

// The same for a field given by its values in device memory; see FieldMesher::mesh_into().
DeviceExtraction mesh_field_on_device(const SampledFieldView& field, const ExtractOptions& options,
                                      const Stream& stream);

// A copy of a mesh of the host, with all its arrays.
DeviceMesh upload_mesh(const IndexedMesh& host, const Stream& stream);

// Copies the mesh to the host, into the memory of the arrays of `host`. Half-edges are copied if
// `connectivity` asks for them; the mesh must have them then.
void download_into(IndexedMesh& host, const DeviceMeshView& mesh, Connectivity connectivity,
                   const Stream& stream);
// download_into() a new mesh.
inline IndexedMesh download(const DeviceMeshView& mesh, Connectivity connectivity,
                            const Stream& stream) {
  IndexedMesh host;
  download_into(host, mesh, connectivity, stream);
  return host;
}

// Bytes that the memory pool of the current device keeps and that no array uses. The pool knows
// this at once, whereas the driver takes as long as a small extraction to say what is free.
std::uint64_t spare_device_memory();

// Bytes of the current device that can still be taken: those that are free, and those that the pool
// keeps. Asks the driver.
std::uint64_t available_device_memory();

// Throws DeviceMemoryExceeded if fewer than `bytes` are available, or if `allowed` is less. `what`
// begins the message.
void require_device_memory(std::uint64_t bytes, const char* what,
                           std::uint64_t allowed = kNoMemoryLimit);

}  // namespace vdwmesh
