// Finds the bricks that the surface may cross by a descent in an octree of blocks of bricks. The
// cost grows with the area of the surface, not with the volume of the grid.
#pragma once

#include <cstdint>
#include <vector>

#include "extract/field.hpp"
#include "spheres/cell_list.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;

// Keys (brick_key) of the bricks in the range that may hold surface, in rising order: all that do,
// and some that the bounds on the field do not rule out. Throws LimitExceeded if a level of the
// octree has more than `most` such blocks, and Cancelled if the monitor asks to stop.
std::vector<std::uint64_t> candidate_bricks(const CellListView& list, const FieldModel& model,
                                            const KeyRange& range, std::uint64_t most,
                                            Monitor* monitor);

// The range enlarged by the bricks to which its triangles, and half-edges if they are wanted,
// refer. A triangle's vertices lie on edges of its cell, which belong to their lower ends, so their
// bricks are the cell's own and neighbours on upper sides, whose keys are higher. The range
// therefore ends with the neighbour beyond the upper corner of the last brick. The opposite of a
// half-edge may be in a neighbour on a lower side, so with half-edges the range begins with the
// neighbour across the lower z face of the first brick, whose key is lowest among these. All bricks
// between must be counted, because the number of a vertex is a sum over all bricks before its own.
KeyRange with_halo(const KeyRange& range, Connectivity connectivity);

// The key from which on bricks of the range may have upper neighbours behind the range. Triangles
// of bricks with lower keys name no vertices there. At least range.begin.
std::uint64_t first_with_border(const KeyRange& range);

}  // namespace vdwmesh
