// The way of our points and meshes to the reference code, which shares no types with src/.
#pragma once

#include "reference/point.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

inline reference::Point to_point(const Vec3d& v) { return {v.x, v.y, v.z}; }

// Positions and triangles alone: the reference code finds everything else by itself.
inline reference::TriangleMesh to_reference(const IndexedMesh& mesh) {
  reference::TriangleMesh result;
  for (const Vec3d& p : mesh.positions) result.points.push_back(to_point(p));
  result.triangles.assign(mesh.triangles.begin(), mesh.triangles.end());
  return result;
}

}  // namespace vdwmesh::testing
