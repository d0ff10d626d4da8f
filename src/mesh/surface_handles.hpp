// Conversions from integers to the typed handles of a SurfaceMesh, and a parallel loop over
// indices. OpenMesh's handles hold an int; callers pass numbers below 2^31 only.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

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

// Indices that a thread takes at a time. A block has to be worth far more than its scheduling.
inline constexpr std::size_t kItemsPerBlock = 1 << 14;

// Calls body(i) for every i below `count`, on all cores and in no particular order.
template <class Body>
void for_each_index(std::size_t count, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kItemsPerBlock),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
                    });
}

}  // namespace vdwmesh::handles
