// What the edges of a triangle soup say about it: one pass that topology and measures share.
#pragma once

#include <cstdint>

#include "core/buffer.hpp"
#include "mesh/edge_buckets.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct EdgeSurvey {
  bool closed, manifold, oriented;  // as in MeshTopology
  std::uint64_t edges;
  std::uint64_t used_vertices;  // on some triangle
  std::uint32_t shells;
  Buffer<std::uint32_t> shell_of;  // of each triangle; shells are numbered by their first triangle
};

// `buckets` are those of the mesh.
EdgeSurvey survey_edges(const IndexedMesh& mesh, const EdgeBuckets& buckets);

}  // namespace vdwmesh
