// Which triangles of a constrained triangulation lie inside its boundary. For host and device, and
// for any PlaneTriangulationOf<Memory>.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "creases/plane/plane_triangulation.hpp"

namespace vdwmesh {

// Marks triangle t unless it is marked, and lists it in `stack` as one to go on from.
template <class Plane, class Stack>
VDWMESH_HD void mark_and_list(Plane& plane, std::uint32_t t, Stack& stack) {
  if (plane.is_inside(t)) return;
  plane.mark_inside(t);
  stack.push_back(t);
}

// Marks all triangles that can be reached from the listed ones without crossing a piece.
template <class Plane, class Stack>
VDWMESH_HD void mark_reachable(Plane& plane, Stack& stack) {
  while (!stack.empty()) {
    const LinkedTriangle& t = plane.triangle(stack.back());
    stack.pop_back();
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (t.pieces[k] == kNoPiece && t.neighbors[k] != kNoNeighbor) {
        mark_and_list(plane, t.neighbors[k], stack);
      }
    }
  }
}

// Calls visit(t) for every marked triangle. Those that visit() adds are not visited.
template <class Plane, class Visit>
VDWMESH_HD void visit_marked(const Plane& plane, const Visit& visit) {
  const auto count = static_cast<std::uint32_t>(plane.triangles().size());
  for (std::uint32_t t = 0; t < count; ++t) {
    if (plane.is_inside(t)) visit(t);
  }
}

}  // namespace vdwmesh
