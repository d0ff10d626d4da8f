// Which bricks the surface can cross: octree descent over blocks of bricks, so that the cost
// follows the surface and not the box.
#pragma once

#include <cstdint>
#include <vector>

#include "core/monitor.hpp"
#include "extract/extractor.hpp"
#include "extract/field.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Keys (brick_key) of the bricks of the range whose bounds admit surface, rising. Throws
// LimitExceeded when there are more than `most`, Cancelled.
std::vector<std::uint64_t> candidate_bricks(const CellListView& list, const FieldModel& model,
                                            const KeyRange& range, std::uint64_t most,
                                            Monitor* monitor);

// The range with the bricks around it to which its triangles and half-edges refer: from the
// neighbour across its first brick's lower z face to the one beyond the upper corner of its last
// brick. What lies between must be counted too, since a number is a sum over all bricks before.
KeyRange with_halo(const KeyRange& range);

}  // namespace vdwmesh
