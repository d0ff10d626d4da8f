// The cells of a regular triangulation by CGAL, which regular_cells() is held against.
#pragma once

#include "complex/regular_cells.hpp"

namespace vdwmesh::testing {

// What regular_cells() returns, but for the order of the cells. CGAL decides ties in the same way.
RegularCells cgal_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                        const TakesCell& takes, std::vector<std::uint8_t>& has_vertex);

}  // namespace vdwmesh::testing
