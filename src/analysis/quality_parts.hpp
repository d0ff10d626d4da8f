// The two halves of quality(), for callers that have the edges at hand.
#pragma once

#include "analysis/mesh_measures.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {

// `buckets` are those of the mesh.
Distribution edge_length_distribution(const IndexedMesh& mesh, const EdgeBuckets& buckets);
// All but the edge lengths.
MeshQuality quality_of_triangles(const IndexedMesh& mesh);

}  // namespace vdwmesh
