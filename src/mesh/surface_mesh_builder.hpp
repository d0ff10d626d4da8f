// Builds a SurfaceMesh in two steps. The first allocates its arrays and needs nothing but the size
// of the mesh, so it can run in the background while the triangles are still being computed.
#pragma once

#include <memory>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

class SurfaceMeshBuilder {
 public:
  // Will fill `mesh`. Precondition: `mesh` is empty, and it outlives the builder at its address.
  explicit SurfaceMeshBuilder(SurfaceMesh& mesh);
  ~SurfaceMeshBuilder();
  SurfaceMeshBuilder(const SurfaceMeshBuilder&) = delete;
  SurfaceMeshBuilder& operator=(const SurfaceMeshBuilder&) = delete;

  // Starts to allocate the arrays of a closed mesh of this size on a thread of TBB's pool, and
  // returns at once. The size is a hint: build() corrects it. Only the first call has an effect.
  // Throws LimitExceeded as build() does.
  void prepare(const MeshSize& size);

  // Fills the mesh as to_surface_mesh() does, with or without a prepare() before, and returns it.
  // Call it at most once. After an exception the mesh is in no defined state.
  SurfaceMesh& build(const IndexedMesh& source);

 private:
  class Room;  // the allocation that prepare() started
  SurfaceMesh& mesh_;
  std::unique_ptr<Room> room_;  // null before prepare()
};

}  // namespace vdwmesh
