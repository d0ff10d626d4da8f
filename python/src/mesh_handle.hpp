// A mesh as Python holds it. All arrays and views of it share one IndexedMesh, which never changes.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <utility>

#include "cuda/on_device.hpp"
#include "extract/grid.hpp"
#include "surface/indexed_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::python {

struct MeshHandle {
  std::shared_ptr<const IndexedMesh> mesh;
  std::shared_ptr<const PatchedMesh> patched;  // of which `mesh` is a part; null: without patches
  std::optional<GridSpec> grid{};              // on which marching cubes made the mesh, if known
};

// A mesh that a device made, in the device's memory.
struct CudaMeshHandle {
  CudaMesh mesh;
  bool has_normals = true;  // whether they were asked for; a refined mesh has them in any case
};

inline MeshHandle handle_of(IndexedMesh&& mesh, const std::optional<GridSpec>& grid = {}) {
  return {std::make_shared<const IndexedMesh>(std::move(mesh)), nullptr, grid};
}

inline MeshHandle handle_of(PatchedMesh&& mesh) {
  const auto patched = std::make_shared<const PatchedMesh>(std::move(mesh));
  return {std::shared_ptr<const IndexedMesh>(patched, &patched->mesh), patched, {}};
}

// For pickle.
pybind11::tuple pickled(const MeshHandle& h);
MeshHandle unpickled(const pybind11::tuple& parts);

}  // namespace vdwmesh::python
