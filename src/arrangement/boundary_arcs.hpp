// The arcs and corners of the union's boundary, placed in space. Lengths are those of the
// triangulation (scaled).
//
// What has no size in double coordinates is left out: an arc of no length (more than three spheres
// through one point) makes its corners one, a circle of no size (contact) parts its two balls, and
// a patch of no width (spheres through one circle) makes the arcs around it one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/exposed_arcs.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// By the radius of the smaller ball: an arc shorter than this is a point.
inline constexpr double kNoArc = 1e-8;
// And a whole circle smaller than this a contact, an arc of one a point: beside it the two spheres
// are nearer to each other than their coordinates are exact.
inline constexpr double kNoCircle = 1e-6;
constexpr bool is_contact(double circle_radius, double smaller_radius) {
  return circle_radius <= kNoCircle * smaller_radius;
}

// The point at angle x from 0 to `sweep` is center + cos x · cosine + sin x · sine, which turns
// counter-clockwise about the axis from the first ball to the second: the patch of the second ball
// lies on the left, that of the first on the right.
struct BoundaryArc {
  std::array<std::uint32_t, 2> balls;  // of the triangulation
  std::array<std::uint32_t, 2> ends;   // corners; kNoIndex: a whole circle
  Vec3d center, cosine, sine;
  double sweep;
  double radius;

  bool is_circle() const { return ends[0] == kNoIndex; }
  Vec3d at(double angle) const;
};

struct BoundaryCorner {
  Vec3d position;
  std::array<std::uint32_t, 3> balls;  // of the triangulation; more may pass through it
};

struct BoundaryArcs {
  std::vector<BoundaryArc> arcs;
  std::vector<BoundaryCorner> corners;
  std::uint64_t points = 0;    // arcs of no length
  std::uint64_t contacts = 0;  // circles of no size
  bool has_joined_corners = false;
};

BoundaryArcs boundary_arcs(const PowerTriangulation& triangulation, const DualComplex& complex);

}  // namespace vdwmesh
