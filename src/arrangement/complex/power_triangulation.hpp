// The regular triangulation of a set of balls as plain arrays.
//
// Four auxiliary points of radius 0 far outside every ball come first into the triangulation, so
// it is three-dimensional for any input and every real simplex is surrounded by cells. Their power
// is positive on all balls, so the dual complex does not see them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/buffer.hpp"
#include "core/monitor.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

struct PowerTriangulation {
  // Balls with distinct centres (of concentric ones the largest, of equal ones the lowest id), in
  // an order that keeps neighbours near, all lengths multiplied by 2^-scale_exponent.
  std::vector<Sphere> balls;
  std::vector<SphereId> ids;  // in the SphereSet, for each ball
  int scale_exponent = 0;

  // Cells with their vertices positively oriented (indices from balls.size() on: auxiliary) and the
  // cell across from each vertex (kNoIndex: none). No ball that the weights hide is in a cell.
  Buffer<std::array<std::uint32_t, 4>> cells, neighbors;

  bool is_ball(std::uint32_t vertex) const { return vertex < balls.size(); }
};

// Vertices of the facet opposite to vertex k of a cell, which sees them positively oriented.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kFacetVertices{
    {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};

// Exact for any finite input. Throws InvalidInput where the extent overflows a double,
// LimitExceeded past 2^32 cells, Cancelled (asked every few thousand balls). Independent of the
// order of the spheres, ids apart.
PowerTriangulation triangulate(const SphereSet& spheres, Monitor* monitor = nullptr);

}  // namespace vdwmesh
