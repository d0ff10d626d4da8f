// A check that all readers of mesh files share.
#pragma once

#include <fmt/format.h>

#include <cstdint>

#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"

namespace vdwmesh::formats {

// Throws LimitExceeded if an IndexedMesh cannot have this many vertices. One index is kept free:
// 2^32 - 1 means "none" in several tables.
inline void check_vertex_limit(std::uint64_t vertices) {
  if (vertices >= kMaxVertices)
    throw LimitExceeded(fmt::format("{} vertices are more than a mesh can hold", vertices));
}

}  // namespace vdwmesh::formats
