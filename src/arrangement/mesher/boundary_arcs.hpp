// The arcs and corners of the union's boundary, placed in space. This is the first step of the
// crease-exact mesher. Lengths are scaled as in the triangulation.
//
// Which arcs and corners exist follows exactly from the dual complex. Features that are too small
// for double coordinates are reduced, and each reduction is counted:
//
// - a short arc (more than three spheres through one point) becomes a point: its corners become
// one;
// - a tiny circle (two balls in contact) vanishes, so the surfaces of its two balls are parted;
// - a patch without width (three spheres through one circle) vanishes: the two arcs beside it
// become
//   one arc between the two outer balls.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/complex/exposed_arcs.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// Which features count as having no size. Both lengths are fractions of the radius of the smaller
// of the two balls that meet in the arc or circle.
struct FeatureSizes {
  // An arc up to this length becomes a point.
  double arc = 1e-8;
  double circle =
      // A whole circle up to this radius is a contact, and an arc of such a circle is a point. Near
      // such a circle the spheres are closer to each other than coordinates are exact.
      1e-6;
};

// A circular arc, or a whole circle, in which two spheres meet.
//
// The point at angle x, 0 <= x <= sweep, is center + cos x · cosine + sin x · sine. With growing x
// it turns counter-clockwise about the axis that points from the first ball to the second. Seen
// from outside the union, the patch of the second ball lies on the left of the arc and the patch of
// the first ball on its right.
struct BoundaryArc {
  std::array<std::uint32_t, 2> balls;  // indices into PowerTriangulation::balls
  std::array<std::uint32_t, 2> ends;   // corners; both kNoIndex: a whole circle
  Vec3d center, cosine, sine;          // the last two have length `radius` and are orthogonal
  double sweep;                        // rad, > 0; 2 pi for a whole circle
  double radius;                       // of the circle

  bool is_circle() const { return ends[0] == kNoIndex; }
  Vec3d at(double angle) const;
};

// An exposed point common to three spheres, or several such points that were joined.
struct BoundaryCorner {
  Vec3d position;
  std::array<std::uint32_t, 3> balls;  // of the triangulation; joined corners lie on more spheres
};

// The arcs and corners, and how many features were reduced to points.
struct BoundaryArcs {
  std::vector<BoundaryArc> arcs;
  std::vector<BoundaryCorner> corners;
  FeatureSizes sizes;          // by which features were reduced
  std::uint64_t points = 0;    // arcs that became a point
  std::uint64_t contacts = 0;  // circles that vanished
  // Corners that were joined without an arc between them, touching circles that got a corner, and
  // patches without width.
  std::uint64_t joins = 0;
  // Whether a corner may lie on more than three spheres. The mesh may then have several fans of
  // triangles at a corner, which split_fans() parts.
  bool has_joined_corners = false;

  // Whether a circle counts as a point of contact. The two radii are in the same unit.
  bool is_contact(double circle_radius, double smaller_radius) const {
    return circle_radius <= sizes.circle * smaller_radius;
  }
};

// Places the boundary. The order of the result depends on the arguments alone.
BoundaryArcs boundary_arcs(const PowerTriangulation& triangulation, const DualComplex& complex,
                           const FeatureSizes& sizes = {});

}  // namespace vdwmesh
