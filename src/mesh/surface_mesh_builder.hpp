// Builds a SurfaceMesh in two steps, so that the first can run while its triangles are still made.
#pragma once

#include <memory>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

class SurfaceMeshBuilder {
 public:
  // Fills `mesh`, which must be new and stay where it is as long as the builder.
  explicit SurfaceMeshBuilder(SurfaceMesh& mesh);
  ~SurfaceMeshBuilder();
  SurfaceMeshBuilder(const SurfaceMeshBuilder&) = delete;
  SurfaceMeshBuilder& operator=(const SurfaceMeshBuilder&) = delete;

  // Begins to make room for a closed mesh of that size on a thread of TBB's pool, and returns at
  // once. Only the first call counts. Throws LimitExceeded as build() does.
  void prepare(const MeshSize& size);

  // Fills the mesh as to_surface_mesh() does, whatever was prepared, and returns it. To be called
  // once; after an exception the mesh is of no use.
  SurfaceMesh& build(const IndexedMesh& source);

 private:
  class Room;
  SurfaceMesh& mesh_;
  std::unique_ptr<Room> room_;
};

}  // namespace vdwmesh
