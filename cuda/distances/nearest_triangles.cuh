// The distances from points in device memory to the nearest triangle of a mesh.
#pragma once

#include "cuda/distances/device_tree.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

// A mesh and the search tree over its triangles.
struct SearchedMesh {
  SoupView mesh;
  BoxTreeView tree;
};

// Writes to `found` the distances of the points (Å), which are in the world of the tree. `reach`
// (Å, at least 0) is a guess: most points should be nearer than that. Distances do not depend on
// it.
void find_nearest_triangles(const SearchedMesh& searched, const DeviceArray<Vec3d>& points,
                            double reach, double* found, const Stream& stream);

}  // namespace vdwmesh::distance
