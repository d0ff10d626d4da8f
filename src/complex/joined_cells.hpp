// A regular triangulation made in blocks of space side by side. For the library's own use.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "complex/regular_cells.hpp"

namespace vdwmesh {

// All cells of the regular triangulation of the balls and the auxiliary points, in some order. The
// cells are the same whatever the number of blocks, which is at least 1.
// Throws as regular_cells() does. Precondition: the largest radius is in [1/2, 1), and no two
// centres are equal.
RegularCells joined_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                          std::size_t blocks, std::uint64_t memory_limit, Monitor* monitor);

}  // namespace vdwmesh
