// Opposite half-edges and edge numbers of a triangle mesh, on all cores.
#pragma once

#include <cstdint>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// The half-edge that runs back along each half-edge; `mesh.opposite`, checked, where it is there.
// Found by the index of the start vertex: coordinates are not looked at. Throws InvalidInput
// naming the first half-edge that does not have exactly one opposite.
Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh);

// Number of the edge of each half-edge. Edges are numbered by their first half-edge.
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite);

}  // namespace vdwmesh
