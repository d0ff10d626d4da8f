// Whether spheres fit given cells, for lists that are not made by CellList.
#pragma once

#include <span>

#include "spheres/cell_list_frame.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Throws InvalidInput for spheres, of these reaches, for which the constructor of a CellList with
// this frame throws.
void require_fit(const CellListFrame& frame, const SphereSet& spheres,
                 std::span<const double> reach);

}  // namespace vdwmesh
