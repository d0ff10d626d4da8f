// The arcs and corners of the union's boundary, placed in space. Lengths are those of the
// triangulation (scaled).
//
// Which arcs and corners there are is exact. What is too small to be placed is left out: an arc of
// no length (more than three spheres through one point) makes its corners one, a circle of no size
// (contact) parts its two balls, and a patch of no width (spheres through one circle) makes the
// arcs around it one. Each such place is counted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/complex/exposed_arcs.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// What counts as having no size, by the radius of the smaller ball.
struct FeatureSizes {
  double arc = 1e-8;  // an arc up to this length is a point
  double circle =
      1e-6;  // a whole circle up to this radius is a contact, an arc of one is a point:
             // beside it the spheres are nearer to each other than coordinates are exact
};

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
  FeatureSizes sizes;
  std::uint64_t points = 0;    // arcs of no length
  std::uint64_t contacts = 0;  // circles of no size
  std::uint64_t joins = 0;  // corners joined without an arc between them, and patches of no width
  bool has_joined_corners = false;

  bool is_contact(double circle_radius, double smaller_radius) const {
    return circle_radius <= sizes.circle * smaller_radius;
  }
};

BoundaryArcs boundary_arcs(const PowerTriangulation& triangulation, const DualComplex& complex,
                           const FeatureSizes& sizes = {});

}  // namespace vdwmesh
