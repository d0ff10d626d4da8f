// The topological properties of a triangle soup that follow from its edges. topology() and
// measures() in mesh_measures.cpp both need them.
#pragma once

#include <cstdint>

#include "analysis/mesh_part.hpp"
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

// What the own edges and vertices of a part say. Parts can be put together: a property holds for
// the whole mesh if it holds for all parts, and counts add up.
struct PartSurvey {
  // `manifold`, as in MeshTopology, is only said of a part that is closed and oriented.
  bool closed, manifold, oriented;
  std::uint64_t edges, used_vertices;
};

// Precondition of both: `buckets` were made from the triangles of the mesh.
PartSurvey survey_part(const MeshPart& part, const EdgeBuckets& buckets);
EdgeSurvey survey_edges(const IndexedMesh& mesh, const EdgeBuckets& buckets);

}  // namespace vdwmesh
