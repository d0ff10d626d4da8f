// The arcs of the union's boundary, from corner to corner, from the dual complex alone.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/complex/dual_complex.hpp"

namespace vdwmesh {

// Corner 2 f + s: on side s of triangle f of the complex; that side is exposed.
using CornerIndex = std::uint64_t;
inline constexpr CornerIndex kNoCorner = ~CornerIndex{0};

// An arc of the circle of an edge, counter-clockwise seen against the axis from the edge's first
// ball to its second. A whole circle has no corners (of a touching edge it is a point).
struct ExposedArc {
  std::uint32_t edge;
  CornerIndex start, end;
};

std::vector<ExposedArc> exposed_arcs(const PowerTriangulation& triangulation,
                                     const DualComplex& complex);

// The side of triangle f that is met first when turning counter-clockwise, away from it, about the
// axis of its edge k.
inline std::size_t leading_side(const DualTriangle& f, std::size_t k) {
  return f.vertices[(k + 1) % 3] < f.vertices[(k + 2) % 3] ? 0 : 1;
}

}  // namespace vdwmesh
