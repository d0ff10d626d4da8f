// How many triangles a mesh with half-edges can have. Arrays of triangles (IndexedMesh) have no
// such limit.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vdwmesh {

// The most half-edges that a SurfaceMesh can have, because OpenMesh's handles are of type int.
inline constexpr std::uint64_t kMaxSurfaceHalfEdges = 0x7fffffffu;

// Throws LimitExceeded for triangles that have more half-edges than that.
void check_triangle_count(std::size_t triangles);

}  // namespace vdwmesh
