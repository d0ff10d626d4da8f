// The steps of quality(), for callers that already have the EdgeBuckets of the mesh, or only a part
// of it. examine() uses them to free the buckets between the two.
#pragma once

#include "analysis/mesh_measures.hpp"
#include "analysis/mesh_part.hpp"
#include "core/buffer.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {

struct TriangleShapes {
  Buffer<double> min_angles_deg;  // one per triangle, 0 for degenerate triangles
  Buffer<double> aspect_ratios;   // of the triangles with an area above 0 only
};

// The shapes of the own triangles.
TriangleShapes triangle_shapes(const MeshPart& part);
// The length of each own edge, once, in the order of the edges' smaller vertices, Å. Precondition:
// `buckets` were made from the triangles of the mesh.
Buffer<double> edge_lengths(const MeshPart& part, const EdgeBuckets& buckets);
// Fills all members of MeshQuality but the edge lengths.
MeshQuality quality_of_triangles(const IndexedMesh& mesh);

}  // namespace vdwmesh
