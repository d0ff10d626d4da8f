// Gives touching arcs of one ball a common corner. The arrangement has no corner there: two circles
// on the ball come close, but they do not cross. Lengths are scaled as in the triangulation.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/boundary_arcs.hpp"

namespace vdwmesh {

// Finds pairs of circles on one ball that come closer to each other than FeatureSizes::arc of its
// radius. Between them the patch has a passage without width in double coordinates, so both circles
// get one corner there. It is a new corner, or an existing one in which an arc ends. Arcs that pass
// through the corner are cut there. Adds corners and arcs to `boundary`, and the number of touching
// points to its `joins`.
//
// Returns pairs of corners that are one point, as indices into `corners`; the caller merges them.
// Throws Cancelled.
std::vector<std::array<std::uint32_t, 2>> join_touching_arcs(const PlacedBalls& balls,
                                                             BoundaryArcs& boundary,
                                                             Monitor* monitor);

}  // namespace vdwmesh
