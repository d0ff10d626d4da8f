// Which triangles of a mesh intersect, from the definition: the intersection of two triangles is
// computed in rational numbers, and looked at for points beyond their shared vertices and edge.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace vdwmesh::testing {

using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

// The pairs in rising order, the lower index first. Triangles of area 0 are left out. `triangles`
// are indices of `positions`; vertices are shared by index.
std::vector<TrianglePair> crossing_pairs(
    const std::vector<std::array<double, 3>>& positions,
    const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace vdwmesh::testing
