// Distances from points to the nearest triangle of a mesh.
#pragma once

#include <span>

#include "analysis/distances_tree.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class MeshFinder {
 public:
  // `world` must contain the mesh and all later query points. The mesh must outlive this.
  MeshFinder(const IndexedMesh& mesh, const Box& world);

  // Writes the distance of each point to `found`, Å. The search is fast if consecutive points are
  // near each other.
  void find(std::span<const Vec3d> points, double* found) const;

 private:
  const IndexedMesh& mesh_;
  BoxTree tree_;
};

}  // namespace vdwmesh
