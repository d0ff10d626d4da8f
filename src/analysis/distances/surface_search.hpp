// Distances from points to the exposed surface, for host and device.
//
// The gap of a ball is the distance of a point from its centre, less its radius: negative inside.
// Let s be the least gap of all balls. Those without exposed points count, because the inside of
// such a ball may be covered by no other; their patches are empty.
//  - Outside the union (s >= 0) the distance is s: no point of any ball is nearer, and the radial
//    projection (foot) on the ball of least gap is exposed, for a ball that covered it would be
//    nearer still.
//  - Inside, no exposed point is nearer than -s: the open ball of radius -s around the point lies
//    within the ball of least gap, and exposed points lie within no ball. If the foot on that ball
//    is exposed, the distance is -s. Most points inside are settled by this one test.
//  - Otherwise all patches are searched for their nearest points, on their feet, arcs and corners.
// Near is what judges the boxes of a node (analysis/distances/box_tree_view.hpp).
//
// Written as one formula, the squared distance inside is the larger of s² and the least of all
// patches' squared distances. It contains no choice, so the result does not depend, to the last
// bit, on the order of the search, on hints, or on the number of points that are searched together.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "analysis/distances/box_tree_view.hpp"
#include "analysis/survey/patch.hpp"
#include "core/host_device.hpp"

namespace vdwmesh {

// The exposed surface as host and device code search it; owns nothing. The primitives of the tree
// are the patches of ExposedSurface::searched().
struct PatchTreeView {
  const Patch* patches;
  const Sphere* balls;  // of the patches: read far more often than the rest of a patch
  BoxTreeView tree;
};

// Comparisons of squares decide which balls cannot matter. This relative margin exceeds the
// rounding of both sides, so a ball is never left out whose gap, as computed, would matter.
inline constexpr double kSquareMargin = 1e-14;

struct LeastGap {
  double gap;  // Å
  std::uint32_t patch;
};

VDWMESH_HD inline double gap_of(const Sphere& ball, const Vec3d& p) {
  const Vec3d to = p - ball.center;
  return std::sqrt(arcs::inner(to, to)) - ball.radius;
}

// The search bound that belongs to a gap, Å²: balls whose boxes are farther have larger gaps.
VDWMESH_HD inline double bound_of_gap(double gap) { return gap > 0 ? gap * gap : 0; }

// Finds the ball of least gap. `hint` is the patch that is measured first.
template <class Near = NearLanes>
VDWMESH_HD inline LeastGap find_least_gap(const PatchTreeView& surface, const Vec3d& p,
                                          std::uint32_t hint) {
  LeastGap found{gap_of(surface.balls[hint], p), hint};
  double bound = bound_of_gap(found.gap);
  visit_nearest<Near>(surface.tree, surface.tree.query(p), bound,
                      [&](std::uint32_t i, double& least) {
                        const Sphere& ball = surface.balls[i];
                        const Vec3d to = p - ball.center;
                        const double square = arcs::inner(to, to);
                        const double reach = ball.radius + found.gap;
                        if (!(reach > 0) || square > reach * reach * (1 + kSquareMargin)) return;
                        const double gap = std::sqrt(square) - ball.radius;
                        if (!(gap < found.gap)) return;
                        found = {gap, i};
                        least = bound_of_gap(gap);
                      });
  return found;
}

// Lowers `squared` to the squared distance from y to circle i, if that distance is smaller and the
// nearest point of the circle is exposed. If the nearest point is covered, the nearest exposed
// point of the circle is a corner at the end of an arc, and update_nearest() examines all corners
// itself. y is relative to the centre of the sphere, and all lengths are in units of its radius.
VDWMESH_HD inline void update_nearest_on_circle(const Patch& patch, std::uint32_t i, const Vec3d& y,
                                                double& squared) {
  const arcs::Cap& cap = patch.covers[i].cap;
  const double height = arcs::inner(cap.axis, y);
  const Vec3d radial = y - height * cap.axis;
  const double length = std::sqrt(arcs::inner(radial, radial));
  const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
  const double up = height - cap.cosine, out = length - radius;
  const double found = up * up + out * out;
  if (!(found < squared)) return;
  // If y is on the axis of the circle, all points of the circle are equally near, and some of them
  // are exposed, because only circles with exposed arcs are examined.
  if (length > 0 && !is_exposed(patch, cap.cosine * cap.axis + (radius / length) * radial, i))
    return;
  squared = found;
}

// Returns whether the foot of p is exposed. From the centre all points of the sphere are equally
// near; whether some are exposed, the patch knows.
VDWMESH_HD inline bool has_exposed_foot(const Patch& patch, const Vec3d& p) {
  const Vec3d from_center = p - patch.ball.center;
  const double length = std::sqrt(arcs::inner(from_center, from_center));
  if (!(length > 0)) return patch.cover_count == 0 || patch.circles > 0;
  return is_exposed(patch, (1 / length) * from_center);
}

// Lowers `squared` (Å²) to the squared distance from p to the patch if that distance is smaller.
// Returns whether `squared` was lowered.
//
// The distance from p to a point of the sphere grows with the angle between that point and the
// direction of p. If that direction is exposed, it gives the nearest point; otherwise the nearest
// point is on the border of the patch, on an arc or at a corner. Along a circle the distance grows
// in the same way with the angle from the nearest point of the circle. No point of the sphere is
// nearer than the gap; the border's distance, which has more roundings, is not let below it. The
// search may therefore leave out a patch because of its gap without changing the result.
VDWMESH_HD inline bool update_nearest(const Patch& patch, const Vec3d& p, double& squared) {
  const double gap = gap_of(patch.ball, p);
  if (!(gap * gap < squared)) return false;
  if (has_exposed_foot(patch, p)) {
    squared = gap * gap;
    return true;
  }
  const double r = patch.ball.radius;
  const Vec3d y = (1 / r) * (p - patch.ball.center);
  // In units of the radius. The comparison in Å² below decides, so this bound may be a little too
  // large: it only lets circles be passed over that are farther than what was found before.
  double best = squared / (r * r) * (1 + kSquareMargin);
  for (std::uint32_t i = 0; i < patch.circles; ++i) update_nearest_on_circle(patch, i, y, best);
  for (std::uint32_t i = 0; i < patch.corner_count; ++i) {
    const Vec3d to = y - patch.corners[i].position;
    const double found = arcs::inner(to, to);
    best = found < best ? found : best;
  }
  double found = best * r * r;
  found = found < gap * gap ? gap * gap : found;
  if (!(found < squared)) return false;
  squared = found;
  return true;
}

// Returns the squared distance, Å², of a point inside the union: by the formula above the larger of
// s², which the caller passes as `least`, and the squared distance to the nearest patch. The search
// may therefore end once a patch is as near as s². A caller to whom distances up to a larger bound
// are alike passes its square instead. `hint` is the patch that is measured first.
template <class Near = NearLanes>
VDWMESH_HD inline double nearest_exposed(const PatchTreeView& surface, const Vec3d& p,
                                         std::uint32_t hint, double least) {
  double squared = std::numeric_limits<double>::infinity();
  update_nearest(surface.patches[hint], p, squared);
  if (squared <= least) return least;
  // A sphere has a point nearer than `reach` only if |p - center| is between radius - reach and
  // radius + reach. The squares are compared, so most balls are rejected without a square root.
  double reach = std::sqrt(squared);
  visit_nearest<Near>(surface.tree, surface.tree.query(p), squared,
                      [&](std::uint32_t i, double& best) {
                        if (best <= least) {
                          best = -1;  // the end: `least` is the result
                          return;
                        }
                        const Sphere& ball = surface.balls[i];
                        const Vec3d to = p - ball.center;
                        const double square = arcs::inner(to, to);
                        const double most = ball.radius + reach, fewest = ball.radius - reach;
                        if (square > most * most * (1 + kSquareMargin)) return;
                        if (fewest > 0 && square < fewest * fewest * (1 - kSquareMargin)) return;
                        if (update_nearest(surface.patches[i], p, best)) reach = std::sqrt(best);
                      });
  return squared < least ? least : squared;
}

// Returns whether the ball of least gap alone decides the distance of a point, which then is its
// gap.
VDWMESH_HD inline bool is_settled(const PatchTreeView& surface, const Vec3d& p,
                                  const LeastGap& nearest) {
  return nearest.gap >= 0 || has_exposed_foot(surface.patches[nearest.patch], p);
}

// Returns the signed distance, Å, of a point that is not settled, by a search of all patches.
template <class Near = NearLanes>
VDWMESH_HD inline double unsettled_distance(const PatchTreeView& surface, const Vec3d& p,
                                            const LeastGap& nearest) {
  return -std::sqrt(nearest_exposed<Near>(surface, p, nearest.patch, nearest.gap * nearest.gap));
}

// Returns the signed distance, Å, of a point whose ball of least gap is known: positive outside the
// union, negative inside.
template <class Near = NearLanes>
VDWMESH_HD inline double signed_distance(const PatchTreeView& surface, const Vec3d& p,
                                         const LeastGap& nearest) {
  return is_settled(surface, p, nearest) ? nearest.gap
                                         : unsettled_distance<Near>(surface, p, nearest);
}

}  // namespace vdwmesh
