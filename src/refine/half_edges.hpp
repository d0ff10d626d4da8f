// Opposite half-edges and edge numbers of a closed triangle mesh, on all cores. Half-edge 3t + k
// runs from vertex k of triangle t to the next vertex of t.
#pragma once

#include <cstdint>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// For each half-edge, the half-edge of the neighbouring triangle that runs back along it. Uses
// `mesh.opposite` if it is filled, after checking it. Only vertex indices are compared, never
// coordinates. Throws InvalidInput, naming the first half-edge that does not have exactly one
// opposite: the mesh is then not closed, not oriented, or not a manifold.
Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh);

// For each half-edge, the number of its edge, from 0. Edges are numbered in the order of their
// lower half-edges. `opposite` must come from find_opposite().
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite);

}  // namespace vdwmesh
