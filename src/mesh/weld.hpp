// Vertices that lie in one place become one.
#pragma once

#include <cstdint>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The same triangles on vertices of which no two have all three coordinates equal, in the order of
// their first appearance. Labels are those of the first; normals, which corners need not agree on,
// and opposite half-edges are left out. Throws InvalidInput for an index of no vertex.
IndexedMesh welded(const IndexedMesh& mesh);

// Bytes that welded() takes at its peak beyond its argument, at most.
std::uint64_t welding_bytes(const MeshSize& size);

}  // namespace vdwmesh
