// Vertices where several fans of triangles meet only in the point.
#pragma once

#include <cstddef>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Of the first `count` vertices, those whose triangles are not one fan get a copy at the end for
// each fan beyond the first (in the order of the triangles), so that the mesh is a 2-manifold.
// `opposite` must be empty. Throws LimitExceeded past 2^32 vertices.
void split_fans(std::size_t count, IndexedMesh& mesh);

}  // namespace vdwmesh
