// Where the surface meets a grid edge, for host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"

namespace vdwmesh {

// A vertex stays this far, in edge lengths, from both ends of its edge.
inline constexpr double kEdgeMargin = 1.0 / (1 << 20);

struct EdgePoint {
  double distance;      // from the inside node along the edge, Å
  std::uint32_t owner;  // union of balls: index of the ball whose interval ends there
  bool clamped;
};

VDWMESH_HD inline EdgePoint clamp_to_edge(double distance, double spacing, std::uint32_t owner) {
  const double least = kEdgeMargin * spacing, most = (1 - kEdgeMargin) * spacing;
  if (!(distance >= least)) return {least, owner, true};
  if (!(distance <= most)) return {most, owner, true};
  return {distance, owner, false};
}

// Blended fields: linear interpolation between the values at the inside and the outside node. An
// outside node of the virtual border may hold a value at or above the isovalue; then the edge is
// cut at its outer end.
VDWMESH_HD inline EdgePoint interpolate_edge(float inside, float outside, float isovalue,
                                             double spacing) {
  if (!(outside < isovalue)) return clamp_to_edge(spacing, spacing, 0);
  const double a = inside, b = outside, t = isovalue;
  return clamp_to_edge((a - t) / (a - b) * spacing, spacing, 0);
}

// Part of a grid line that a ball covers, measured from the inside node towards the outside node.
struct Interval {
  double enter, exit;
  bool empty;
};

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

// Where a ball that holds the node ends: rounding may end its interval before the node.
VDWMESH_HD inline double exit_of_holder(const Sphere& ball, const Vec3d& node, int axis,
                                        double direction) {
  const Interval i = cover(ball, node, axis, direction);
  return i.empty || !(i.exit > 0) ? 0 : i.exit;
}

struct UnionExit {
  double distance;      // from the inside node along the edge, Å
  std::uint32_t owner;  // index of the ball whose interval ends there
};

// Union of balls: the first exit from the union seen from the inside node. Intervals are merged
// from the node outwards; the balls that hold the node (same predicate as its sign) begin the run,
// and balls that reach the edge within its length extend it. Where several end it exactly, the
// lowest rank owns. for_each(visit) calls visit(ball, rank, index) for any superset of the balls
// that touch the edge: further ones change nothing. Not clamped to the edge.
template <class ForEach>
VDWMESH_HD UnionExit union_exit(const Vec3d& node, int axis, double direction, double spacing,
                                ForEach&& for_each) {
  double reach = -1;
  std::uint32_t owner = 0, owner_rank = 0;
  bool others = false;  // balls that do not hold the node: those that do change nothing later
  const auto end_at = [&](double exit, std::uint32_t rank, std::uint32_t index) {
    if (exit == reach && rank >= owner_rank) return;
    reach = exit;
    owner = index;
    owner_rank = rank;
  };
  for_each([&](const Sphere& ball, std::uint32_t rank, std::uint32_t index) {
    if (!inside_ball(node, ball)) {
      others = true;
      return;
    }
    const double exit = exit_of_holder(ball, node, axis, direction);
    if (exit >= reach) end_at(exit, rank, index);
  });
  for (bool grown = others; grown;) {
    grown = false;
    for_each([&](const Sphere& ball, std::uint32_t rank, std::uint32_t index) {
      const Interval i = cover(ball, node, axis, direction);
      if (i.empty || i.exit < reach || i.enter > reach || i.enter > spacing) return;
      grown |= i.exit > reach;
      end_at(i.exit, rank, index);
    });
  }
  return {reach, owner};
}

template <class ForEach>
VDWMESH_HD EdgePoint first_exit(const Vec3d& node, int axis, double direction, double spacing,
                                ForEach&& for_each) {
  const UnionExit exit = union_exit(node, axis, direction, spacing, for_each);
  return clamp_to_edge(exit.distance, spacing, exit.owner);
}

}  // namespace vdwmesh
