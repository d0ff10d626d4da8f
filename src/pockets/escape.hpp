// The widest ways from places to infinity, in distances: for the library's own use.
#pragma once

#include <optional>
#include <vector>

#include "complex/power_triangulation.hpp"
#include "pockets/clearance.hpp"

namespace vdwmesh {

class Monitor;

// Where a walk to a point begins: in a cell at infinity it would end at once. Cell 0 if all are.
std::uint32_t first_finite_cell(const PowerTriangulation& triangulation);

// The cell that contains a point, found by a walk from another cell: every step goes to the other
// side of a face, and in a regular triangulation such a walk ends.
std::uint32_t cell_at(const PowerTriangulation& triangulation, const Vec3d& place,
                      std::uint32_t from);

// For each place the greatest clearance below which no way to infinity has to go, at most that of
// the place itself. All balls shrink for it if it is negative: nothing where one would vanish
// first. Lengths are scaled as in the triangulation, which is that of the balls as they are.
std::vector<std::optional<double>> escape_clearances(const PowerTriangulation& triangulation,
                                                     const std::vector<ClearPlace>& places,
                                                     Monitor* monitor);

}  // namespace vdwmesh
