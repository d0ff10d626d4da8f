// Newton projection of one point (3.7), for host and device: p <- p - f grad f / |grad f|^2.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "extract/blended/field_sample.hpp"
#include "refine/refiner.hpp"
#include "refine/sphere_formulas.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

enum class ProjectionOutcome : std::uint8_t { converged, unconverged, out_of_reach };

struct ProjectedPoint {
  Vec3d position;       // the start, bit for bit, unless converged away from it
  double residual;      // Å, distance to the surface (first order, for a field)
  SphereId spheres[3];  // as VertexSpheres; kNoSphere unless converged
  int steps;
  ProjectionOutcome outcome;
};

// How far a vertex may be moved in all ("reach", Å). The safeguard of both projections: the ends
// of an edge lie on the surface, so its midpoint has surface within half the edge's length; a
// nearest point further away belongs to another part of it. A given vertex may cross its
// longest edge: marching cubes leaves it within a cell of the surface. Whoever would go further
// stays where he was, so no vertex jumps across a gap or through a wall.
VDWMESH_HD inline double midpoint_reach(const Vec3d& a, const Vec3d& b) {
  return 0.5 * norm(b - a);
}

VDWMESH_HD inline bool within_reach(const Vec3d& p, const Vec3d& start, double reach) {
  return squared_distance(p, start) <= reach * reach;
}

// The last three different spheres that p was moved to, latest first, and how often in a row the
// nearest one was among them: once is an alternation between two, twice one among three.
struct SphereHistory {
  std::uint32_t place[3];
  int count, returns;
};

// Moves `place` to the front and says where it was; `count` where it was not.
VDWMESH_HD inline int note_sphere(SphereHistory& h, std::uint32_t place) {
  int at = 0;
  while (at < h.count && h.place[at] != place) ++at;
  const int was = at;
  if (at == 3) at = 2;
  for (int i = at; i > 0; --i) h.place[i] = h.place[i - 1];
  h.place[0] = place;
  if (was == h.count) {
    h.returns = 0;
    if (h.count < 3) ++h.count;
    return 3;
  }
  if (was > 0) ++h.returns;
  return was;
}

// The label of p: the first `count` spheres of the history by rank.
VDWMESH_HD inline void label_by_rank(const CellListView& list, const std::uint32_t* place,
                                     int count, SphereId* label) {
  std::uint32_t sorted[3];
  for (int i = 0; i < count; ++i) {
    int at = i;
    for (; at > 0 && list.rank[place[i]] < list.rank[sorted[at - 1]]; --at) {
      sorted[at] = sorted[at - 1];
    }
    sorted[at] = place[i];
  }
  for (int i = 0; i < 3; ++i) label[i] = i < count ? list.id[sorted[i]] : kNoSphere;
}

struct UnionStep {
  FoundPoint to;
  int spheres;  // how many of the history's first it lies on
};

// Onto the nearest sphere; where the nearest alternates between two, onto their circle; among
// three, onto their corner. Newton's step on d - r is exact, since its gradient is a unit vector.
VDWMESH_HD inline UnionStep step_to_union(const CellListView& list, SphereHistory& history,
                                          std::uint32_t nearest, const Vec3d& p) {
  const int was = note_sphere(history, nearest);
  const Sphere& a = list.spheres[nearest];
  if (was == 1 || was == 2) {
    const Sphere& b = list.spheres[history.place[1]];
    if (history.returns >= 2 && history.count == 3) {
      const FoundPoint corner = nearest_corner(a, b, list.spheres[history.place[2]], p);
      if (corner.found) return {corner, 3};
    }
    const FoundPoint circle = nearest_on_circle(a, b, p);
    if (circle.found) return {circle, 2};
  }
  return {nearest_on_sphere(a, p), 1};
}

// Projection onto the boundary of the union of the balls of `list` (reach = radius). |min(d - r)|
// is never more than the distance to the boundary, so a start beyond `reach` by it is out of reach.
// nearest(p) is the ball of least d - r among those within reach + kProjectionTolerance of p.
template <class Nearest>
VDWMESH_HD inline ProjectedPoint project_to_union(const CellListView& list, const Vec3d& start,
                                                  double reach, Nearest&& nearest) {
  using std::abs;
  ProjectedPoint result{
      start, 0, {kNoSphere, kNoSphere, kNoSphere}, 0, ProjectionOutcome::unconverged};
  SphereHistory history{{0, 0, 0}, 0, 0};
  UnionStep step{{start, true}, 0};
  for (;; ++result.steps) {
    const NearestBall near = nearest(step.to.position);
    result.residual = abs(near.gap);
    if (near.found && result.residual <= kProjectionTolerance) {
      if (step.spheres == 0) history.place[0] = near.place;
      result.position = step.to.position;
      label_by_rank(list, history.place, step.spheres == 0 ? 1 : step.spheres, result.spheres);
      result.outcome = ProjectionOutcome::converged;
      return result;
    }
    if (result.steps == 0 && !(near.found && result.residual <= reach)) {
      result.outcome = ProjectionOutcome::out_of_reach;
      return result;
    }
    if (result.steps == kMaxProjectionSteps || !near.found) return result;
    step = step_to_union(list, history, near.place, step.to.position);
    if (!step.to.found || !within_reach(step.to.position, start, reach)) return result;
  }
}
VDWMESH_HD inline ProjectedPoint project_to_union(const CellListView& list, const Vec3d& start,
                                                  double reach) {
  return project_to_union(list, start, reach, [&](const Vec3d& p) {
    return nearest_ball(list, p, kProjectionTolerance, reach + kProjectionTolerance);
  });
}

// Newton on F = T. A step is halved until |F - T| falls within the reach, so an overshoot across a
// steep or flat part of the field is taken back; every sample of the field counts as a step. Out of
// reach is who fails from further away than the reach, to first order.
VDWMESH_HD inline ProjectedPoint project_to_field(const CellListView& list, const FieldModel& model,
                                                  const Vec3d& start, double reach) {
  using std::abs;
  ProjectedPoint result{
      start, 0, {kNoSphere, kNoSphere, kNoSphere}, 0, ProjectionOutcome::out_of_reach};
  Vec3d p = start;
  FieldSample here = sample_field(list, model, p);
  if (!here.in_reach) return result;
  for (;;) {
    const double miss = here.value - model.isovalue;
    const double square = squared_norm(here.gradient);
    if (!(square > 0)) return result;
    const double distance = abs(miss) / std::sqrt(square);
    if (distance <= kProjectionTolerance) {
      result.position = p;
      result.residual = distance;
      result.spheres[0] = list.id[here.place];
      result.outcome = ProjectionOutcome::converged;
      return result;
    }
    if (result.steps == 0 && distance <= reach) result.outcome = ProjectionOutcome::unconverged;
    double step = distance <= reach ? 1 : reach / distance;
    for (bool closer = false; !closer; step *= 0.5) {
      if (result.steps == kMaxProjectionSteps) return result;
      ++result.steps;
      const Vec3d q = along(p, -(step * miss / square), here.gradient);
      if (!within_reach(q, start, reach)) continue;
      const FieldSample there = sample_field(list, model, q);
      closer = abs(there.value - model.isovalue) < abs(miss);
      if (!closer) continue;
      p = q;
      here = there;
    }
  }
}

}  // namespace vdwmesh
