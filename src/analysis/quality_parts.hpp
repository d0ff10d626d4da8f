// The two parts of quality(), for callers that already have the EdgeBuckets of the mesh. examine()
// uses them to free the buckets between the two.
#pragma once

#include "analysis/mesh_measures.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {

// Precondition: `buckets` were made from the triangles of `mesh`.
Distribution edge_length_distribution(const IndexedMesh& mesh, const EdgeBuckets& buckets);
// Fills all members of MeshQuality but the edge lengths.
MeshQuality quality_of_triangles(const IndexedMesh& mesh);

}  // namespace vdwmesh
