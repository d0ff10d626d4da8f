// The topological properties of a triangle soup that follow from its edges. topology() and
// measures() in mesh_measures.cpp both need them.
#pragma once

#include <cstdint>

#include "core/buffer.hpp"
#include "mesh/edge_buckets.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct EdgeSurvey {
  bool closed, manifold, oriented;  // as in MeshTopology
  std::uint64_t edges;
  std::uint64_t used_vertices;  // vertices that are on some triangle
  std::uint32_t shells;         // number of pieces that are connected across edges
  // The shell of each triangle. Shells are numbered from 0 in the order of their first triangles.
  Buffer<std::uint32_t> shell_of;
};

// Precondition: `buckets` were made from the triangles of `mesh`.
EdgeSurvey survey_edges(const IndexedMesh& mesh, const EdgeBuckets& buckets);

}  // namespace vdwmesh
