// Merges vertices of a mesh that have equal coordinates.
#pragma once

#include <cstdint>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Returns the mesh with vertices merged if all three coordinates are equal, without a tolerance; 0
// and -0 are equal. Vertices keep the order of their first appearance, and triangles keep their
// order. A merged vertex has the label of the first. The result has no normals, because merged
// vertices may have different ones, and no opposite half-edges. Throws InvalidInput if a triangle
// has an index of no vertex.
IndexedMesh welded(const IndexedMesh& mesh);

// An upper bound of the bytes that welded() needs in addition to a mesh of this size.
std::uint64_t welding_bytes(const MeshSize& size);

}  // namespace vdwmesh
