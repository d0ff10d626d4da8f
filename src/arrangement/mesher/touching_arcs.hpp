// Arcs of one ball that touch where the arrangement has no corner. Lengths are those of the
// triangulation (scaled).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/mesher/boundary_arcs.hpp"

namespace vdwmesh {

// Where two circles of a ball lie side by side and all but touch (to FeatureSizes::arc of its
// radius), the passage between them has no width in double coordinates: the arcs there get one
// corner, new or one that an arc ends in. Returns pairs of corners that are one point.
std::vector<std::array<std::uint32_t, 2>> join_touching_arcs(
    const PowerTriangulation& triangulation, BoundaryArcs& boundary);

}  // namespace vdwmesh
