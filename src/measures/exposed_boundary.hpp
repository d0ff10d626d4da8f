// The exposed corners and arcs of the union's boundary as combinatorics: which balls meet there,
// and which corners an arc joins. They come from the dual complex; their order follows from the
// numbers of the balls alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "core/no_index.hpp"

namespace vdwmesh {

struct DualComplex;
struct PowerTriangulation;

// An exposed point common to three spheres. The two points that they have in common lie on either
// side of the plane of their centres: side 0 is the one from which the centres of balls[0],
// balls[1] and balls[2] are counter-clockwise, side 1 the other. Corners are sorted in this order.
struct ExposedCorner {
  std::array<std::uint32_t, 3> balls;  // ascending
  std::uint32_t side;
  friend auto operator<=>(const ExposedCorner&, const ExposedCorner&) = default;
};

// An exposed arc of the circle in which two spheres meet. It runs counter-clockwise about the axis
// from the first ball to the second, seen from the second. An arc without corners is a whole
// circle, or a point if the balls only touch. Arcs are sorted in this order; two arcs differ in
// their balls or in the corner at which they start.
struct CornerArc {
  std::array<std::uint32_t, 2> balls;    // ascending
  std::array<std::uint32_t, 2> corners;  // indices; kNoIndex twice: a whole circle
  bool is_circle() const { return corners[0] == kNoIndex; }
  friend auto operator<=>(const CornerArc&, const CornerArc&) = default;
};

struct ExposedBoundary {
  Buffer<ExposedCorner> corners;
  Buffer<CornerArc> arcs;
  // By ball, ascending: the balls that share an edge of the dual complex with it, exposed or not.
  std::span<const std::uint32_t> neighbors(std::uint32_t ball) const {
    return {neighbor_lists.data() + first_neighbor[ball],
            first_neighbor[ball + 1] - first_neighbor[ball]};
  }
  Buffer<std::uint32_t> neighbor_lists;
  std::vector<std::size_t> first_neighbor;  // by ball, and the end of the last row
  std::vector<double> areas;                // exposed, by ball; scaled as the balls are
};

ExposedBoundary exposed_boundary(const PowerTriangulation& triangulation,
                                 const DualComplex& complex);

}  // namespace vdwmesh
