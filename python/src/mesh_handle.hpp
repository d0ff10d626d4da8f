// A mesh as Python holds it. All arrays and views of it share one IndexedMesh, which never changes.
#pragma once

#include <memory>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh::python {

struct MeshHandle {
  std::shared_ptr<const IndexedMesh> mesh;
};

inline MeshHandle handle_of(IndexedMesh&& mesh) {
  return {std::make_shared<const IndexedMesh>(std::move(mesh))};
}

}  // namespace vdwmesh::python
