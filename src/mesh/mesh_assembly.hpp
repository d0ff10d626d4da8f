// What the readers share while they put a mesh together.
#pragma once

#include <fmt/format.h>

#include <cstdint>

#include "core/errors.hpp"
#include "mesh/mesh_io.hpp"

namespace vdwmesh::formats {

inline void check_vertex_limit(std::uint64_t vertices) {
  if (vertices >= kMaxVertices)
    throw LimitExceeded(fmt::format("{} vertices are more than a mesh can hold", vertices));
}

}  // namespace vdwmesh::formats
