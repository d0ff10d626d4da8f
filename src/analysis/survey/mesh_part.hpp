// A part of a mesh, as a process has it that measures the whole together with others. A whole mesh
// is a part too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Every vertex and every triangle of the whole mesh is own to one part. An edge is own to the part
// that has its smaller vertex. Beside its own triangles and their vertices, `mesh` has all
// triangles of other parts at an own vertex, with their vertices. So a part knows all triangles
// around its vertices and at its edges. Which of two vertices is the smaller one is the same in all
// parts that have both.
struct MeshPart {
  const IndexedMesh& mesh;          // positions and triangles
  std::size_t vertices, triangles;  // the own ones, which are the first so many
  // [i]: 1 if vertex `vertices` + i, of another part, is larger than all own ones, 0 if it is
  // smaller than all of them.
  std::span<const std::uint8_t> is_larger;

  // Whether own vertex v is smaller than vertex w.
  bool is_smaller(std::uint32_t v, std::uint32_t w) const {
    return v < w && (w < vertices || is_larger[w - vertices] != 0);
  }
};

inline MeshPart whole(const IndexedMesh& mesh) {
  return {mesh, mesh.vertex_count(), mesh.triangle_count(), {}};
}

}  // namespace vdwmesh
