// A mesh as Python holds it. All arrays and views of it share one IndexedMesh, which never changes.
#pragma once

#include <memory>

#include "cuda/on_device.hpp"
#include "surface/indexed_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::python {

struct MeshHandle {
  std::shared_ptr<const IndexedMesh> mesh;
  std::shared_ptr<const PatchedMesh> patched;  // of which `mesh` is a part; null: without patches
};

// A mesh that a device made, in the device's memory.
struct CudaMeshHandle {
  CudaMesh mesh;
  bool has_normals = true;  // whether they were asked for; a refined mesh has them in any case
};

inline MeshHandle handle_of(IndexedMesh&& mesh) {
  return {std::make_shared<const IndexedMesh>(std::move(mesh)), nullptr};
}

inline MeshHandle handle_of(PatchedMesh&& mesh) {
  const auto patched = std::make_shared<const PatchedMesh>(std::move(mesh));
  return {std::shared_ptr<const IndexedMesh>(patched, &patched->mesh), patched};
}

}  // namespace vdwmesh::python
