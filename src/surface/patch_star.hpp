// A divided triangle with its four children as a piece of the fans of its corners.
//
// The fan of a vertex u of the mesh that was divided is made of the divided triangles around it,
// called patches. It is a disc: consecutive patches share the edge from u and its midpoint. Its
// border has the other halves of edges: of each patch the two halves of the edge that does not end
// in u.
#pragma once

#include <initializer_list>

#include "surface/fan_lanes.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {

// Judges all three corners of a patch at once, one in each lane. `corner` and `middle` are the
// positions of the corners and of the midpoints, `direction` the directions of the corners' fans.
VDWMESH_INLINE void add_patch(StarFans& fans, const Triangle& vertex, const LanePoint& corner,
                              const LanePoint& middle, const LanePoint& direction) {
  FanLanes fan(corner, direction);
  const PlaneLanes next = fan.image(of_next(corner)), previous = fan.image(of_previous(corner)),
                   to_next = fan.image(middle), across = fan.image(of_next(middle)),
                   to_previous = fan.image(of_previous(middle));
  Lanes least = cross_of(to_next, to_previous);
  for (const Lanes& other : {area_of(next, across, to_next), area_of(previous, to_previous, across),
                             area_of(to_next, across, to_previous), cross_of(next, across),
                             cross_of(across, previous)}) {
    least = other < least ? other : least;
  }
  const LaneBits crosses = FanLanes::crosses(next, across) | FanLanes::crosses(across, previous);
  fans.add(vertex, fan.holds(least), bits_of(crosses));
}

}  // namespace vdwmesh
