// The caps that all other balls of a union cover on one sphere.
#pragma once

#include <utility>

#include "arrangement/arcs/arc_cap.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh::arcs {

// Calls take(cap, other) for the cap of every ball that cuts the ball at list place `place`;
// `other` is its list place. Returns false, and stops, at the first ball that buries this one. Of
// equal balls the one of the lowest id buries the others.
template <class Take>
bool visit_caps(const CellListView& list, std::uint32_t place, const Take& take) {
  const Sphere& ball = list.spheres[place];
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  return !visit_near_box(list, ball.center - r, ball.center + r, [&](std::uint32_t other) {
    const Sphere& near = list.spheres[other];
    if (near.center == ball.center && near.radius == ball.radius)
      return list.id[other] < list.id[place];
    Cap cap;
    const CapKind kind = make_cap(ball, near, cap);
    if (kind == CapKind::cuts) take(std::as_const(cap), other);
    return kind == CapKind::buries;
  });
}

}  // namespace vdwmesh::arcs
