// What the readers share while they put a mesh together.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"

namespace vdwmesh::formats {

// Indices of one polygon, already checked, as a fan of triangles.
inline void add_fan(IndexedMesh& mesh, const std::vector<std::uint32_t>& polygon) {
  for (std::size_t i = 2; i < polygon.size(); ++i)
    mesh.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
}

// What happened to polygons, for the notes.
struct PolygonCount {
  std::uint64_t fanned = 0;   // more than three corners
  std::uint64_t too_few = 0;  // fewer than three

  void count(std::size_t corners) {
    fanned += corners > 3;
    too_few += corners < 3;
  }
  void note(std::vector<std::string>& notes) const {
    if (fanned > 0) notes.push_back(fmt::format("{} polygons were fanned into triangles", fanned));
    if (too_few > 0)
      notes.push_back(fmt::format("{} faces of fewer than three corners were left out", too_few));
  }
};

inline void check_vertex_limit(std::uint64_t vertices) {
  if (vertices >= kMaxVertices)
    throw LimitExceeded(fmt::format("{} vertices are more than a mesh can hold", vertices));
}

}  // namespace vdwmesh::formats
