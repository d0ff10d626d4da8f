// The arcs of the union's boundary, from corner to corner. They follow from the dual complex alone,
// without coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "complex/dual_complex.hpp"

namespace vdwmesh {

// Corner 2 f + s lies on side s (0 or 1) of triangle f of the complex. Only exposed sides have
// corners.
using CornerIndex = std::uint64_t;
inline constexpr CornerIndex kNoCorner = ~CornerIndex{0};

// An exposed arc of the circle of an edge. It runs counter-clockwise about the axis from the edge's
// first ball to its second, seen from the second. An arc without corners is the whole circle, or a
// point if the edge is touching.
struct ExposedArc {
  std::uint32_t edge;      // of the complex
  CornerIndex start, end;  // both kNoCorner on a whole circle
  friend auto operator<=>(const ExposedArc&, const ExposedArc&) = default;
};

// All exposed arcs, sorted by edge, and on one circle by the corner at which they start. So the
// arcs whose lower ball is the same follow each other, in the order of these balls.
std::vector<ExposedArc> exposed_arcs(const PowerTriangulation& triangulation,
                                     const DualComplex& complex);

// Given the corner at which an exposed arc of an edge's circle ends: the corner at which the next
// exposed arc of the circle begins, counter-clockwise. It is the start of the same arc if the
// circle has no other.
CornerIndex next_start(const PowerTriangulation& triangulation, const DualComplex& complex,
                       std::uint32_t edge, CornerIndex end);

// Edge k of triangle f is opposite to vertex k. Its axis runs from its lower to its higher vertex
// number. Returns the side of f that comes first when a half-plane turns from f counter-clockwise
// about that axis.
inline std::size_t leading_side(const DualTriangle& f, std::size_t k) {
  return f.vertices[(k + 1) % 3] < f.vertices[(k + 2) % 3] ? 0 : 1;
}

}  // namespace vdwmesh
