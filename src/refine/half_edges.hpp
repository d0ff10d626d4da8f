// Opposite half-edges and edge numbers of a closed triangle mesh, on all cores. Half-edge 3t + k
// runs from vertex k of triangle t to the next vertex of t.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// For each half-edge its opposite: the half-edge of the neighbouring triangle that runs along the
// same edge the other way. If `mesh.opposite` is filled, it is checked and returned. Only vertex
// indices are compared, never coordinates. Throws InvalidInput if some half-edge does not have
// exactly one opposite, and names the first of them: the mesh is then not closed, not oriented, or
// not a manifold.
Buffer<std::uint32_t> find_opposite(const IndexedMesh& mesh);

// Throws what find_opposite() throws for half-edge h, which is one of the triangle.
[[noreturn]] void throw_not_closed(const Triangle& triangle, std::uint64_t h);

// In place of an opposite half-edge: there is none. Every half-edge has a lower index, since a mesh
// has at most kMaxHalfEdges = 2^32 - 1 of them.
inline constexpr std::uint32_t kUnmatched = std::numeric_limits<std::uint32_t>::max();

// For each half-edge of any triangles the only half-edge that runs back along its edge, and
// kUnmatched if there is none, or more than one. Corners of triangles must be below `vertices`.
Buffer<std::uint32_t> match_half_edges(std::span<const Triangle> triangles, std::size_t vertices);

// For each half-edge, the number of its edge, from 0. Edges are numbered in the order of their
// lower half-edges. `opposite` must come from find_opposite().
Buffer<std::uint32_t> number_edges(const Buffer<std::uint32_t>& opposite);

}  // namespace vdwmesh
