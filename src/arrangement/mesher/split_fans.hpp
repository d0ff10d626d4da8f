// Makes a mesh manifold at vertices in which several fans of triangles meet only in the point.
#pragma once

#include <cstddef>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Splits non-manifold vertices among the first `count` ones: vertices whose triangles form more
// than one fan. A fan is a set of triangles around the vertex that are connected by common edges.
// The first fan (in the order of the triangles) keeps the vertex. Each other fan gets a copy of it
// at the end of the mesh. A vertex is relabelled if its label lacks a sphere of its fan. If all
// other vertices are manifold, so is the mesh afterwards.
//
// Precondition: `opposite` is empty. Throws LimitExceeded past 2^32 vertices.
void split_fans(std::size_t count, IndexedMesh& mesh);

}  // namespace vdwmesh
