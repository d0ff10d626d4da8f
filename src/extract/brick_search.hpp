// Which bricks the surface can cross: octree descent over blocks of bricks, so that the cost
// follows the surface and not the box.
#pragma once

#include <cstdint>
#include <vector>

#include "core/monitor.hpp"
#include "extract/field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Keys (brick_key) of the bricks whose bounds admit surface, rising. Throws LimitExceeded when
// there are more than `most`, Cancelled.
std::vector<std::uint64_t> candidate_bricks(const CellListView& list, const FieldModel& model,
                                            std::uint64_t most, Monitor* monitor);

}  // namespace vdwmesh
