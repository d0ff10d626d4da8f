// The pieces of a concave patch from the loops of its boundary.
#pragma once

#include "excluded/patches/concave_patch.hpp"

namespace vdwmesh::excluded {

// Chains the segments of a patch to loops and measures the pieces that they bound. A patch with a
// loop that does not close, or with a hole in no piece, is not certified.
void join_loops(ConcavePatch& patch);

}  // namespace vdwmesh::excluded
