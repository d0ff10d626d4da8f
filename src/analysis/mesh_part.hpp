// A part of a mesh, as a process has it that measures the whole together with others. A whole mesh
// is a part too.
#pragma once

#include <cstddef>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Every vertex and every triangle of the whole mesh is own to one part. An edge is own to the part
// that has its smaller vertex. Beside its own triangles and their vertices, `mesh` has all
// triangles of other parts at an own vertex, with their vertices. So a part knows all triangles
// around its vertices and at its edges. Vertices that are in several parts have the same order in
// all of them.
struct MeshPart {
  const IndexedMesh& mesh;               // positions and triangles
  std::size_t first_vertex, end_vertex;  // the own vertices
  std::size_t triangles;                 // the own triangles are the first so many
};

inline MeshPart whole(const IndexedMesh& mesh) {
  return {mesh, 0, mesh.vertex_count(), mesh.triangle_count()};
}

}  // namespace vdwmesh
