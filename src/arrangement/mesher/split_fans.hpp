// Makes a mesh manifold at vertices in which several fans of triangles meet only in the point.
#pragma once

#include <cstddef>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Splits the non-manifold vertices among the first `count` vertices of the mesh. A fan is a set of
// triangles around a vertex that are connected by common edges at the vertex; a vertex with more
// than one fan is not manifold. The fan of the first triangle keeps the vertex. Each other fan gets
// a copy of it at the end of the mesh. If the label of the vertex lacks a sphere of a fan, the
// vertex of this fan gets the spheres of the fan as its label, unless they are more than three. If
// all other vertices are manifold, so is the mesh afterwards.
//
// Precondition: the mesh has normals and labels, and `opposite` is empty, because it would not
// follow the change. Throws LimitExceeded past 2^32 vertices.
void split_fans(std::size_t count, IndexedMesh& mesh);

}  // namespace vdwmesh
