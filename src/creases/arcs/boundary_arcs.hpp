// The arcs and corners of the union's boundary, placed in space. This is the first step of the
// crease-exact mesher. Lengths are scaled as in the triangulation.
//
// Which arcs and corners exist follows exactly from the dual complex. Features that are too small
// for double coordinates are reduced, and each reduction is counted:
//
// - a short arc becomes a point, and its two corners become one. Such arcs arise if more than three
//   spheres pass through one point;
// - a tiny circle, in which two balls all but touch, vanishes, and the surfaces of the two balls
//   are parted there;
// - a patch without width vanishes, and the two arcs beside it become one arc between the two outer
//   balls. Such patches arise if three spheres pass through one circle.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/buffer.hpp"
#include "core/host_device.hpp"
#include "core/no_index.hpp"
#include "core/vec3.hpp"
#include "creases/sine_cosine.hpp"

namespace vdwmesh {

struct ExposedBoundary;
class Monitor;
struct PlacedBalls;

// Which features count as having no size. Both lengths are fractions of the radius of the smaller
// of the two balls that meet in the arc or circle.
struct FeatureSizes {
  // An arc up to this length becomes a point.
  double arc = 1e-8;
  // A whole circle up to this radius is a contact, and an arc of such a circle is a point. Near it
  // the spheres are closer to each other than coordinates are exact.
  double circle = 1e-6;
};

// A circular arc, or a whole circle, in which two spheres meet.
//
// The point at angle x, 0 <= x <= sweep, is center + cos x · cosine + sin x · sine, where `cosine`
// and `sine` are vectors. With growing x the point turns counter-clockwise about the axis that
// points from the first ball to the second. Seen from outside the union, the patch of the second
// ball lies on the left of the arc and the patch of the first ball on its right.
struct BoundaryArc {
  std::array<std::uint32_t, 2> balls;  // indices into PlacedBalls::balls
  std::array<std::uint32_t, 2> ends;   // first and last corner; kNoIndex twice: a whole circle
  Vec3d center, cosine, sine;          // the last two have length `radius` and are orthogonal
  double sweep;                        // rad, the angle of the last corner; 2 pi for a whole circle
  double radius;                       // of the circle

  VDWMESH_HD bool is_circle() const { return ends[0] == kNoIndex; }
  // The point at this angle (rad). Sine and cosine are our own, so it does not depend on the C
  // library and is the same on a device.
  VDWMESH_HD Vec3d at(double angle) const {
    const SineCosine turn = sine_cosine(angle);
    return center + (turn.cosine * cosine + turn.sine * sine);
  }
};

// An exposed point common to three spheres, or several such points that were joined.
struct BoundaryCorner {
  Vec3d position;
  // Three balls whose spheres pass through the corner; indices as in BoundaryArc. A joined corner
  // may lie on more spheres.
  std::array<std::uint32_t, 3> balls;
};

// The arcs and corners, and how many features were reduced to points.
struct BoundaryArcs {
  Buffer<BoundaryArc> arcs;
  Buffer<BoundaryCorner> corners;
  FeatureSizes sizes;          // by which features were reduced
  std::uint64_t points = 0;    // arcs that became a point
  std::uint64_t contacts = 0;  // circles that vanished
  // Corners that were joined although no short arc connects them, places where touching circles got
  // a corner, and patches without width that were closed.
  std::uint64_t joins = 0;
  // Whether a corner may lie on more than three spheres. The mesh may then have several fans of
  // triangles at a corner, which split_fans() parts.
  bool has_joined_corners = false;

  // Whether a circle counts as a point of contact. `smaller_radius` belongs to the smaller of its
  // two balls; both radii are in the same unit.
  bool is_contact(double circle_radius, double smaller_radius) const {
    return circle_radius <= sizes.circle * smaller_radius;
  }
};

// Places the boundary. Without reduced features, arcs and corners have the order of `exposed`.
// Throws Cancelled.
BoundaryArcs boundary_arcs(const PlacedBalls& balls, const ExposedBoundary& exposed,
                           const FeatureSizes& sizes = {}, Monitor* monitor = nullptr);

// A step of boundary_arcs(), in touching_arcs.cpp: gives touching arcs of one ball a common corner.
// The arrangement has no corner there: two circles on the ball come close, but they do not cross.
//
// Finds pairs of circles on one ball that come closer to each other than FeatureSizes::arc of its
// radius. Between them the patch has a passage without width in double coordinates, so both circles
// get one corner there. It is a new corner, or an existing one in which an arc ends. Arcs that pass
// through the corner are cut there. Adds corners and arcs to `boundary`, and the number of touching
// points to its `joins`.
//
// Returns pairs of corners that are one point, as indices into `corners`; the caller merges them.
// Throws Cancelled.
std::vector<std::array<std::uint32_t, 2>> join_touching_arcs(const PlacedBalls& balls,
                                                             BoundaryArcs& boundary,
                                                             Monitor* monitor);

}  // namespace vdwmesh
