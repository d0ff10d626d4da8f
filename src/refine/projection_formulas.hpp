// Projection of one point onto the surface by Newton steps, for host and device. CPU and CUDA run
// this same code, so their vertices agree bit for bit.
//
// A Newton step for the surface f = 0 is p <- p - f grad f / |grad f|^2 (equation 3.7 of the
// thesis). For a blended field F with isovalue T, f is F - T. For the union of the balls f is the
// least d - r over the balls, where d is the distance to a ball's centre and r its radius.
//
// Balls are named by their list places, the order of the cell list. Vertex labels have sphere ids.
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

// Converged: within kProjectionTolerance of the surface. Out of reach: the start is further from
// the surface than a vertex may move. Unconverged: every other failure.
struct ProjectedPoint {
  Vec3d position;       // the start itself, bit for bit, unless converged after a step
  double residual;      // Å, distance to the surface if converged; to first order for a field
  SphereId spheres[3];  // the label, as VertexSpheres; kNoSphere unless converged
  int steps;            // Newton steps; for a field, the points that were tried, also in vain
  ProjectionOutcome outcome;
};

// The largest distance (Å) that a midpoint of the edge a b may move from its start. The functions
// below call such a limit the reach. The ends of an edge lie on the surface, so there is surface
// within half an edge length of the midpoint. If the projection would go further, it has found
// another part of the surface. The vertex then stays where it was, so that no vertex jumps across a
// gap. A vertex of the given mesh has a wider limit, the length of its longest edge, because
// marching cubes leaves it within a grid cell of the surface.
VDWMESH_HD inline double midpoint_reach(const Vec3d& a, const Vec3d& b) {
  return 0.5 * norm(b - a);
}

VDWMESH_HD inline bool within_reach(const Vec3d& p, const Vec3d& start, double reach) {
  return squared_distance(p, start) <= reach * reach;
}

// The last three different spheres that were nearest to the point, the latest first. If the nearest
// sphere is one that the point has just left, radial steps alone would go to and fro between these
// spheres and might never end.
struct SphereHistory {
  ListPlace place[3];
  // `count` is the number of entries in use, 0 to 3. `returns` says how often in a row the nearest
  // sphere was in the history, but not its latest entry. After one return the point alternates
  // between two spheres; after two or more it may go round three.
  int count, returns;
};

// Notes the nearest sphere: moves or inserts it at the front of the history,
// where it may push out the oldest entry. Returns the index that it had before, or 3 if it was not
// in the history.
VDWMESH_HD inline int note_sphere(SphereHistory& h, ListPlace place) {
  int at = 0;
  while (at < h.count && h.place[at] != place) ++at;
  const int was = at;   // h.count if the sphere is not there
  if (at == 3) at = 2;  // a full history loses its last entry
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

// Writes the label of a vertex on `count` spheres: their ids in canonical order, then kNoSphere.
// `place` has their list places. The sort by rank is an insertion sort.
VDWMESH_HD inline void label_by_rank(const CellListView& list, const ListPlace* place, int count,
                                     SphereId* label) {
  ListPlace sorted[3];
  for (int i = 0; i < count; ++i) {
    int at = i;
    for (; at > 0 && list.rank[place[i]] < list.rank[sorted[at - 1]]; --at) {
      sorted[at] = sorted[at - 1];
    }
    sorted[at] = place[i];
  }
  for (int i = 0; i < 3; ++i) label[i] = i < count ? list.id[sorted[i]] : kNoSphere;
}

// The end of a step, and on how many spheres it lies: on those of the first `spheres` entries of
// the history. The start of a projection has 0, since no step has led there.
struct UnionStep {
  FoundPoint to;
  int spheres;
};

// One step towards the boundary of the union, given the list place of the ball nearest to p. The
// step leads radially to the nearest sphere. If the nearest sphere alternates between two spheres,
// the step leads to the circle in which they meet; if it goes round three, to their corner. If
// there is no such circle or corner, the next simpler step is taken. A radial step is the whole
// Newton step: d - r is linear along the radius with slope 1, so one step reaches the sphere.
VDWMESH_HD inline UnionStep step_to_union(const CellListView& list, SphereHistory& history,
                                          ListPlace nearest, const Vec3d& p) {
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

// Projects `start` onto the boundary of the union of the balls of `list`, a list whose reach is the
// radius. nearest(p) must return a NearestBall: the ball of least d - r among those with d - r of
// at most reach + kProjectionTolerance, or none.
//
// Outside the union the least d - r is the distance to the boundary. Inside, its absolute value is
// the distance to the sphere of one ball, and the boundary is at least that far away. So if the
// absolute value exceeds `reach` at the start, no point of the boundary is within reach.
template <class Nearest>
VDWMESH_HD inline ProjectedPoint project_to_union(const CellListView& list, const Vec3d& start,
                                                  double reach, Nearest&& nearest) {
  using std::abs;
  ProjectedPoint result{
      start, 0, {kNoSphere, kNoSphere, kNoSphere}, 0, ProjectionOutcome::unconverged};
  SphereHistory history{{}, 0, 0};
  UnionStep step{{start, true}, 0};
  for (;; ++result.steps) {
    const NearestBall near = nearest(step.to.position);
    result.residual = abs(near.gap);
    if (near.found && result.residual <= kProjectionTolerance) {
      // Without a step the history is empty, and the vertex lies on its nearest sphere.
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
    if (result.steps == kMaxProjectionSteps || !near.found) return result;  // unconverged
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

// Projects `start` onto the isosurface F = T of a blended field, by Newton steps with backtracking.
// Each step is shortened to `reach` if it is longer. Then it is halved until the new point is
// within `reach` of the start and |F - T| is smaller there. Without the halving, a step could
// overshoot a bend of the field. Every point that is tried counts as a step, so there are at most
// kMaxProjectionSteps of them. The distance to the surface is estimated to first order as |F - T| /
// |grad F|.
//
// A failure is `out_of_reach` if this estimate at the start exceeds `reach`, or if no atom
// contributes to the field there or the gradient is zero. Any other failure is `unconverged`.
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
    // The start is near enough, so that a failure from here on means no convergence.
    if (result.steps == 0 && distance <= reach) result.outcome = ProjectionOutcome::unconverged;
    double step = distance <= reach ? 1 : reach / distance;  // fraction of the Newton step
    // `continue` and the end of the loop body both go on with half the step.
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
