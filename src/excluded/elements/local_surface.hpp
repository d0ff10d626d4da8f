// Single elements that double leaves undecided, from the exact arrangement of the balls around
// them. For the library's own use.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "excluded/elements/element_shapes.hpp"

namespace vdwmesh::excluded::elements {

// A ball in memory of the host.
struct HostBall {
  Sphere grown;
  double radius;  // without the probe
  std::uint32_t set, place;
};
// The balls around the elements to decide, in ascending order of their places and sets.
struct HostBalls {
  std::span<const HostBall> balls;
  double probe;

  // Precondition: the ball is among them.
  const HostBall& at(std::uint32_t place) const {
    return *std::ranges::lower_bound(balls, place, {}, &HostBall::place);
  }
};

// A place around which balls are needed: those whose grown balls are nearer than `reach`.
struct Around {
  Vec3d point;
  double reach;
};
VDWMESH_HD inline bool is_around(const Around& around, const Sphere& grown) {
  const double far = (around.reach + grown.radius) * (1 + 1e-9);
  return squared_norm(grown.center - around.point) < far * far;
}
VDWMESH_HD inline Around around_circle(const Sphere& a, const Sphere& b) {
  const PairCircle circle = pair_circle(a, b);
  return {a.center + circle.height[0] * circle.axis, circle.radius};
}
// The place around a probe with all balls that reach it, or reach another probe that overlaps it.
VDWMESH_HD inline Around around_corner(const Sphere& first, const ProbeCorner& corner,
                                       double probe) {
  return {first.center + corner.at, 2 * probe};
}

// An arc of the circle of two balls, as Arc names it.
struct ExactArc {
  std::uint32_t third[2];
  double turns;
};

// The exposed arcs of the circle of balls a < b in their order around it. Nothing if one of them
// may be without length: then its corners are one probe, which only the whole set can tell.
std::optional<std::vector<ExactArc>> exact_circle(const HostBalls& balls, std::uint32_t a,
                                                  std::uint32_t b);

// Places a corner of a thin triangle, or with its mirror image next to it, in wide numbers.
void place_exactly(const HostBalls& balls, ProbeCorner& corner);

// The concave patch of a low probe. Nothing if the probe touches more than three balls, or if a
// decision was a tie: ties are broken in the same way for all patches only if the whole set is at
// hand.
std::optional<PatchMeasures> exact_patch(const HostBalls& balls, const ProbeCorner& corner);

}  // namespace vdwmesh::excluded::elements
