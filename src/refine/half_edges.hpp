// Opposite half-edges and edge numbers of a closed triangle mesh, on all cores. Half-edge 3t + k
// runs from vertex k of triangle t to the next vertex of t.
#pragma once

#include <cstdint>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// For each half-edge its opposite: the half-edge of the neighbouring triangle that runs along the
// same edge the other way. If `mesh.opposite` is filled, it is checked and returned. Only vertex
// indices are compared, never coordinates. Throws InvalidInput if some half-edge does not have
// exactly one opposite, and names the first of them: the mesh is then not closed, not oriented, or
// not a manifold.
Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh);

// For each half-edge, the number of its edge, from 0. Edges are numbered in the order of their
// lower half-edges. `opposite` must come from find_opposite().
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite);

}  // namespace vdwmesh
