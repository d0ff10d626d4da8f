// Makes the half-edge structure of a SurfaceMesh from all triangles at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh/surface_mesh.hpp"

namespace vdwmesh {

// Where the opposite half-edges come from. `given`: from the caller of the library, so they have to
// be checked. `computed`: from opposite_half_edges(), which has checked the triangles.
enum class Opposites { given, computed };

// Gives the mesh its vertices, edges and faces and links them; positions and properties stay unset.
// `opposite` has one entry per half-edge 3t + k, as opposite_half_edges() returns them. Throws as
// to_surface_mesh() does.
void connect(SurfaceMesh& mesh, std::span<const Triangle> triangles,
             std::span<const std::uint32_t> opposite, std::size_t vertex_count, Opposites origin);

}  // namespace vdwmesh
