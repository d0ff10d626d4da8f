// The first look at a mesh that nobody has checked.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Throws InvalidInput unless each optional array of the mesh is empty or has one element per
// vertex, triangle or half-edge.
void check_array_sizes(const IndexedMesh& mesh);

struct TriangleCheck {
  // The number of the first triangle that names a vertex twice, if there is one. This is no error
  // here: the analysis says that such a mesh is no manifold, and opposite_half_edges() refuses it.
  std::optional<std::size_t> repeated_index;
  std::size_t half_edges = 0;  // those whose ends differ
};

// Throws InvalidInput, which names the first of them, if a triangle has an index of vertex_count or
// more. On all cores.
TriangleCheck check_triangles(std::span<const Triangle> triangles, std::size_t vertex_count);

}  // namespace vdwmesh
