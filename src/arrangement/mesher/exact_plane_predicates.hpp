// Orientation and in-circle tests in exact arithmetic, for what the filters of plane_predicates.hpp
// leave undecided. Runs on the host only.
#pragma once

#include "arrangement/mesher/plane_predicates.hpp"

namespace vdwmesh {

// 1 if c lies on the left of the line from a to b, -1 if on the right, 0 if on the line.
int exact_orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

// For counter-clockwise a, b, c: 1 if d lies inside the circle through them, -1 if outside, 0 if on
// the circle.
int exact_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                    const PlanePoint& d);

}  // namespace vdwmesh
