// The point in which the surface meets a crossed grid edge. For blended fields and sampled fields
// it follows from linear interpolation between the values at the ends. For the union of balls it is
// the first exit from the union, found by merging the intervals in which balls cover the edge. Host
// and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"
#include "spheres/list_place.hpp"

namespace vdwmesh {

// A vertex stays this far, in edge lengths, from both ends of its edge. This keeps the vertices on
// edges that meet in a node apart.
inline constexpr double kEdgeMargin = 1.0 / (1 << 20);

struct EdgePoint {
  double distance;      // from the inside node along the edge, Å
  std::uint32_t owner;  // union of balls: the caller's index of the ball whose interval ends there
  bool clamped;         // moved by clamp_to_edge()
};

// Moves a point at a distance (Å) from the inside node into the part of the edge where vertices may
// lie. The negated comparisons also move a distance that is not a number, to the inside end.
VDWMESH_HD inline EdgePoint clamp_to_edge(double distance, double spacing, std::uint32_t owner) {
  const double least = kEdgeMargin * spacing, most = (1 - kEdgeMargin) * spacing;
  if (!(distance >= least)) return {least, owner, true};
  if (!(distance <= most)) return {most, owner, true};
  return {distance, owner, false};
}

// Linear interpolation between the values at the inside and the outside node. A virtual node is
// outside by definition, but its value may be at or above the isovalue. Then the vertex is clamped
// to the outer end of the edge. The owner 0 has no meaning for these fields.
VDWMESH_HD inline EdgePoint interpolate_edge(float inside, float outside, float isovalue,
                                             double spacing) {
  if (!(outside < isovalue)) return clamp_to_edge(spacing, spacing, 0);
  const double a = inside, b = outside, t = isovalue;
  return clamp_to_edge((a - t) / (a - b) * spacing, spacing, 0);
}

// The part of a grid line that a ball covers. Positions are measured from the inside node towards
// the outside node.
struct Interval {
  double enter, exit;  // Å
  bool empty;
};

// The ball's interval on the line through `node` along the axis. `direction` is +1 if the outside
// node is above `node` and -1 if it is below. With the distance a of the line from the centre, the
// interval is the centre's position plus and minus sqrt(r^2 - a^2).
VDWMESH_HD inline Interval cover(const Sphere& ball, const Vec3d& node, int axis,
                                 double direction) {
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  const double du = node[u] - ball.center[u], dv = node[v] - ball.center[v];
  const double square = ball.radius * ball.radius - std::fma(du, du, dv * dv);
  if (!(square >= 0)) return {0, 0, true};
  const double middle = direction * (ball.center[axis] - node[axis]);
  const double half = std::sqrt(square);
  return {middle - half, middle + half, false};
}

// End of the interval of a ball that holds the node, hence at least 0. If rounding has made the
// interval empty or has ended it before the node, the end is taken to be 0, the node itself.
VDWMESH_HD inline double exit_of_holder(const Sphere& ball, const Vec3d& node, int axis,
                                        double direction) {
  const Interval i = cover(ball, node, axis, direction);
  return i.empty || !(i.exit > 0) ? 0 : i.exit;
}

struct UnionExit {
  double distance;      // from the inside node along the edge, Å
  std::uint32_t owner;  // index of the ball whose interval ends there
};

// Union of balls: the first exit from the union, seen from the inside node. This is the end of the
// connected run of covered points that begins at the node.
// 1. The balls that hold the node begin the run; it ends where the farthest of them ends. The
//    predicate is the same as for the node's sign, so there is at least one.
// 2. A ball whose interval contains the end of the run, and begins before the edge ends, extends
//    the run to its own end. This repeats over all balls until none extends the run.
// If several intervals end exactly at the exit, the ball of lowest rank owns it. for_each(visit)
// calls visit(ball, rank, index) for all balls that touch the edge and possibly for others, which
// change nothing; `index` is the caller's number for the ball. If visit() returns false, the ball
// changes nothing any more, and later calls of for_each may leave it out. The result is not clamped
// to the edge.
template <class ForEach>
VDWMESH_HD UnionExit union_exit(const Vec3d& node, int axis, double direction, double spacing,
                                ForEach&& for_each) {
  double reach = -1;  // end of the run so far; -1 is below every exit, because exits are at least 0
  std::uint32_t owner = 0;
  Rank owner_rank{};
  bool others = false;  // some ball does not hold the node; if all do, step 2 changes nothing
  // Ends the run at an exit that is at or beyond its end; of equal exits the lower rank wins.
  const auto end_at = [&](double exit, Rank rank, std::uint32_t index) {
    if (exit == reach && rank >= owner_rank) return;
    reach = exit;
    owner = index;
    owner_rank = rank;
  };
  for_each([&](const Sphere& ball, Rank rank, std::uint32_t index) {
    if (!inside_ball(node, ball)) {
      others = true;
      return true;
    }
    const double exit = exit_of_holder(ball, node, axis, direction);
    if (exit >= reach) end_at(exit, rank, index);
    // Its interval ends at `exit`, or before the node if that is 0: step 2 meets nothing new in it.
    return false;
  });
  for (bool grown = others; grown;) {
    grown = false;
    for_each([&](const Sphere& ball, Rank rank, std::uint32_t index) {
      const Interval i = cover(ball, node, axis, direction);
      if (i.empty || i.exit < reach || i.enter > spacing) return false;
      if (i.enter > reach) return true;  // the run may still grow to where the interval begins
      grown |= i.exit > reach;
      end_at(i.exit, rank, index);
      return false;
    });
  }
  return {reach, owner};
}

// union_exit(), clamped to the edge.
template <class ForEach>
VDWMESH_HD EdgePoint first_exit(const Vec3d& node, int axis, double direction, double spacing,
                                ForEach&& for_each) {
  const UnionExit exit = union_exit(node, axis, direction, spacing, for_each);
  return clamp_to_edge(exit.distance, spacing, exit.owner);
}

}  // namespace vdwmesh
