// Distances from points to the nearest triangle of a mesh.
#pragma once

#include <span>

#include "analysis/distances/distances_tree.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class MeshFinder {
 public:
  // `world` must contain the mesh and all later query points. The mesh must outlive this.
  MeshFinder(const IndexedMesh& mesh, const Box& world);

  // Writes the distance of each point to `found`, Å. The search is fast if consecutive points are
  // near each other.
  void find(std::span<const Vec3d> points, double* found) const;

  // Returns the larger of `largest` and the largest distance of the points, Å, as find() computes
  // it. Points that have a triangle within the largest distance so far are not searched for.
  double largest_distance(std::span<const Vec3d> points, double largest) const;

 private:
  const IndexedMesh& mesh_;
  std::uint32_t run_;  // consecutive triangles that are one primitive of the tree
  BoxTree tree_;
};

}  // namespace vdwmesh
