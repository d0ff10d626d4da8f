// The half-edge structure of a SurfaceMesh from triangles, in bulk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

// Whether the opposite half-edges come from elsewhere and have to be checked.
enum class Opposites { given, computed };

// Gives the mesh its vertices, edges and faces and links them. Throws as to_surface_mesh() does.
void connect(SurfaceMesh& mesh, std::span<const Triangle> triangles,
             std::span<const std::uint32_t> opposite, std::size_t vertex_count, Opposites origin);

}  // namespace vdwmesh
