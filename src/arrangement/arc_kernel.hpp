// One ball of a union, for host and device: no allocation, no containers, memory of the caller.
//
// Legendre's theorem on unions of balls: the exposed part of a sphere is its intersection with the
// ball's power cell, so only caps whose plane bounds the cell have to be looked at, and the
// volume of ball ∩ power cell comes from the same edges as the exposed area.
#pragma once

#include "arrangement/arc_measure.hpp"

namespace vdwmesh::arcs {

// Area of the exposed sphere and volume of ball ∩ power cell, both for the unit ball. Sorts the
// caps. Equal results for every order of the caps.
VDWMESH_HD inline BallMeasures measure_ball(Cap* caps, std::uint32_t count,
                                            const ArcWorkspace& workspace) {
  if (count == 0) return {4 * kPi, 4 * kPi / 3, 0};
  sort_caps(caps, count);
  BallCell cell(workspace);
  std::uint32_t used = 0;
  for (; used < count && !cell.empty(); ++used) {
    if (cell.closed() && caps[used].cosine >= cell.reach()) break;
    if (used > 0 && same_cap(caps[used], caps[used - 1])) continue;
    cell.cut(caps[used]);
  }
  return measure_cell(cell, caps, count);
}

}  // namespace vdwmesh::arcs
