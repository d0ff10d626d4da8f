// Conversions from integers to the typed handles of a SurfaceMesh. OpenMesh's handles hold an int;
// callers pass numbers below 2^31 only.
#pragma once

#include <cstddef>
#include <cstdint>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh::handles {

inline OpenMesh::HalfedgeHandle half_edge(std::uint32_t i) {
  return OpenMesh::HalfedgeHandle(static_cast<int>(i));
}
inline OpenMesh::VertexHandle vertex(std::size_t i) {
  return OpenMesh::VertexHandle(static_cast<int>(i));
}
inline OpenMesh::FaceHandle face(std::size_t i) {
  return OpenMesh::FaceHandle(static_cast<int>(i));
}

}  // namespace vdwmesh::handles
