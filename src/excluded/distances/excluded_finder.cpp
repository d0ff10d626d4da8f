// ExcludedFinder: signed distances to the excluded surface. The distance to the accessible surface
// decides for most points; for the others the nearest crease or cusp is searched. As in the header,
// σ is the signed distance of a point to the accessible surface, p the probe's radius, x the
// accessible point nearest to the point, and z the point at the distance p from x on the ray from x
// through the point.
//
// A grown ball is an atom with the probe's radius added. A point is accessible if no grown ball has
// it inside: a probe's centre can be there. Let q be a point inside of a grown ball, and x the
// accessible point nearest to q. The gap of a ball of centre c and radius R is |q - c| - R. The
// foot of q on a ball is the point of its sphere nearest to q. Claim: x is the foot of q on the
// ball of least gap, or x is on an arc. Proof: suppose that x is in the interior of the patch of
// ball i. The points of this sphere around x are accessible, so none of them is nearer to q than x;
// hence x is the foot of q on ball i. If q were outside of ball i, the segment from q to its foot
// would stay outside of ball i. Just before x it would run inside of another ball, because no
// accessible point is nearer than x. Then x would be on that ball's sphere too, and thus on an arc.
// So q is inside of ball i. No other ball j contains x, so |q - c_j| >= R_j - |q - x|: no gap is
// less than that of ball i. Therefore one test of that foot and one search of all arcs find x.
//
// For the exterior surface only points of the outer region count as accessible, and a foot in a
// cavity is not x. Let q be in a cavity, outside of all balls. Claim: x is on an arc. Proof:
// otherwise x is, as above, the foot of q on the ball i of its patch. Since q is outside of ball i,
// the points just before x on the segment from q to x are outside of ball i too. They are in the
// outer region, as x is on no other sphere, and nearer to q than x: a contradiction.
//
// Steps for one point, the cheapest test first:
//  1. If the point is outside all grown balls, the distance is σ + p. If the foot on the ball of
//     least gap is exposed, it is x. Then z is a point of an atom's sphere, which no probe reaches,
//     and the distance is again σ + p. In both cases σ is the least gap.
//  2. Otherwise x is the nearest point of all arcs. It gives σ, and σ + p is the candidate.
//  3. If no crease or cusp is nearer than the nearest atom, the distance is the candidate.
//  4. Otherwise it is the candidate if no probe reaches z, and else the distance to the nearest
//     crease or cusp.
#include "excluded/distances/excluded_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/lanes/multiversion.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::excluded {
namespace {

double largest_radius(std::span<const Patch> patches) {
  double largest = 0;
  for (const Patch& patch : patches) largest = std::max(largest, patch.ball.radius);
  return largest;
}

// The part of the box that lies in `world`, a box around all grown balls and all query points.
// `world` contains every arc, but the box of an arc may reach beyond it.
Box within(Box box, const Box& world) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::max(box.lower[axis], world.lower[axis]);
    box.upper[axis] = std::min(box.upper[axis], world.upper[axis]);
  }
  return box;
}

// The search tree over the boxes of arcs. A tree must have at least one primitive. Without arcs it
// gets a box of one point, in which nobody searches: distance_of() and nearest_arc() return before.
BoxTree tree_of(std::span<const CircleArc> arcs, const Box& world) {
  const auto size = static_cast<std::uint32_t>(std::max<std::size_t>(arcs.size(), 1));
  return BoxTree(size, world, [&](std::uint32_t i) {
    return i < arcs.size() ? within(arcs[i].box(), world) : Box{world.lower, world.lower};
  });
}

// What a search looks at; owns nothing.
struct FinderView {
  PatchTreeView accessible;
  BoxTreeView curve_tree, arc_tree;
  std::span<const CircleArc> curves;  // creases and cusps of the excluded surface
  std::span<const CircleArc> arcs;    // of the accessible surface
  double probe, tolerance;            // Å
  const JudgedSurface& surface;       // says which probes count: all, or those of the outer region
  ByListPlace<SphereId> sphere_of;
};

// Whether the ball of least gap alone gives σ: a probe that counts can stand at the point's foot on
// that ball. Then σ is the least gap.
//
// A ball's centre has no single foot. If no other ball covers a part of the sphere, the whole
// sphere is of one region, and any of its points says which. Otherwise the answer is false if only
// some probes count, and the search of the arcs gives σ: a patch of the sphere in the outer region
// has an arc on its border, which is as far from the centre as the gap says.
bool is_decided(const FinderView& s, const Vec3d& point, const LeastGap& least) {
  if (!is_settled(s.accessible, point, least)) return false;
  if (s.surface.includes_all()) return true;
  const Patch& patch = s.accessible.patches[least.patch];
  const Vec3d from_center = point - patch.ball.center;
  const double length = norm(from_center);
  if (!(length > 0) && patch.cover_count > 0) return false;
  const double radius = patch.ball.radius;
  const Vec3d to_foot = length > 0 ? (radius / length) * from_center : Vec3d{radius, 0, 0};
  return s.surface.includes_point(s.sphere_of[patch.place], patch.ball.center + to_foot);
}

// The distance to the nearest crease or cusp, Å, if that is below `bound` (Å); otherwise the bound.
// The search ends early at a curve no farther than `least` (Å), because the caller only needs to
// know that there is one. visit_nearest() ends when its bound is negative.
double distance_to_curves(const FinderView& s, const Vec3d& point, double least, double bound) {
  double nearest = bound * bound, search_bound = nearest;  // Å²
  visit_nearest(s.curve_tree, s.curve_tree.query(point), search_bound,
                [&](std::uint32_t i, double& until) {
                  nearest = std::min(nearest, s.curves[i].squared_distance(point));
                  until = nearest <= least * least ? -1 : nearest;
                });
  return std::sqrt(nearest);
}

// The arc nearest to a point, and the squared distance to it.
struct NearestArc {
  double squared;  // Å²
  std::uint32_t arc = kNoIndex;
};

// The nearest arc, if its squared distance is below `squared_bound`; otherwise no arc and the
// bound. The caller knows that no arc is nearer than `squared_least`, so an arc that is no farther
// ends the search. The arc `hint` is measured first.
NearestArc nearest_arc(const FinderView& s, const Vec3d& point, double squared_least,
                       double squared_bound, std::uint32_t hint) {
  NearestArc found{squared_bound};
  if (s.arcs.empty()) return found;
  const auto offer = [&](std::uint32_t i) {
    const double squared = s.arcs[i].squared_distance(point);
    if (squared < found.squared) found = {squared, i};
  };
  offer(hint);
  double search_bound = found.squared;
  visit_nearest(s.arc_tree, s.arc_tree.query(point), search_bound,
                [&](std::uint32_t i, double& until) {
                  offer(i);
                  until = found.squared <= squared_least ? -1 : found.squared;
                });
  return found;
}

// Whether no probe reaches z, the point at the distance p from x on the ray from x through the
// point. x is the nearest point of the nearest arc. If x is the point itself, there is no ray.
bool is_beyond_probes(const FinderView& s, const Vec3d& point, const NearestArc& nearest,
                      const LeastGap& least) {
  const Vec3d x = s.arcs[nearest.arc].nearest_point(point), to = point - x;
  const double length = norm(to);
  if (!(length > 0)) return true;
  const Vec3d z = x + (s.probe / length) * to;
  const LeastGap at_z = find_least_gap(s.accessible, z, least.patch);
  // No probe reaches z if every accessible point is at least this far from z. If z is inside of a
  // ball, the least gap is negative, and no accessible point is nearer to z than -gap. If z is
  // decided, some accessible point is at just this distance, or z is accessible itself; so a probe
  // reaches z.
  const double out_of_reach = s.probe - s.tolerance;
  if (-at_z.gap >= out_of_reach) return true;
  if (is_decided(s, z, at_z)) return false;
  const double squared = out_of_reach * out_of_reach;
  return nearest_arc(s, z, 0, squared, nearest.arc).squared >= squared;
}

// The signed distance of a point whose grown ball of least gap is known, Å, by the steps listed
// above. `hint` is the arc that is measured first; it becomes the nearest arc.
double distance_of(const FinderView& s, const Vec3d& point, const LeastGap& least,
                   std::uint32_t& hint) {
  const double to_atom = least.gap + s.probe;
  if (is_decided(s, point, least)) return to_atom;
  // No arc is nearer than |gap|: inside of a ball that is the depth, and for a point in a cavity no
  // sphere is nearer. Rounding may give an arc a little less.
  const double squared_gap = least.gap * least.gap;
  const NearestArc nearest =
      nearest_arc(s, point, squared_gap, std::numeric_limits<double>::infinity(), hint);
  if (nearest.arc != kNoIndex) hint = nearest.arc;
  const double candidate = s.probe - std::sqrt(std::max(nearest.squared, squared_gap));  // σ + p
  // At σ <= -p the candidate always holds.
  if (!(candidate > 0) || s.curves.empty()) return candidate;
  // The distance is at most that to the nearest atom, which is below p in a grown ball (the minimum
  // guards against rounding). Curves that are farther away do not matter.
  const double bound = std::min(to_atom, s.probe);
  const double to_curves = distance_to_curves(s, point, candidate, bound);
  if (!(to_curves > candidate) || !(to_curves < bound)) return candidate;
  return is_beyond_probes(s, point, nearest, least) ? candidate : to_curves;
}

// The nearest accessible point, if the ball of least gap has it.
std::optional<Vec3d> foot_on_ball(const FinderView& s, const Vec3d& point, const LeastGap& least) {
  const Sphere& ball = s.accessible.balls[least.patch];
  const Vec3d from_center = point - ball.center;
  const double length = norm(from_center);
  if (!(length > 0)) return std::nullopt;
  return ball.center + (ball.radius / length) * from_center;
}

JudgedPoint judged(const FinderView& s, const Vec3d& point, const LeastGap& least, double reach,
                   std::uint32_t& hint) {
  JudgedPoint found{.distance = distance_of(s, point, least, hint),
                    .depth = std::max(-least.gap, 0.0),
                    .foot = std::nullopt,
                    .to_curves = distance_to_curves(s, point, 0, reach),
                    .by_curve = false};
  if (is_decided(s, point, least)) {
    found.foot = least.gap < 0 ? foot_on_ball(s, point, least) : std::optional(point);
    return found;
  }
  const double squared_gap = least.gap * least.gap;
  const NearestArc nearest =
      nearest_arc(s, point, squared_gap, std::numeric_limits<double>::infinity(), hint);
  found.depth = std::sqrt(std::max(nearest.squared, squared_gap));
  if (nearest.arc != kNoIndex) found.foot = s.arcs[nearest.arc].nearest_point(point);
  found.by_curve = found.distance > s.probe - found.depth;
  return found;
}

VDWMESH_MULTIVERSION void judge_all(const FinderView& s, std::span<const Vec3d> points,
                                    const LeastGap* nearest, std::span<const double> reach,
                                    JudgedPoint* found) {
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    found[i] = judged(s, points[i], nearest[i], reach[i], hint);
  }
}

VDWMESH_MULTIVERSION void measure_all(const FinderView& s, std::span<const Vec3d> points,
                                      const LeastGap* nearest, double* found) {
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    found[i] = distance_of(s, points[i], nearest[i], hint);
  }
}

}  // namespace

// The exposure of points is decided as if radii were wrong by up to kExposureTolerance of
// themselves. So a point that a probe reaches by less than the tolerance counts as not reached. The
// factor 4 keeps the tolerance clear of that error (docs/excluded_surface.md, "In double").
ExcludedFinder::ExcludedFinder(const ExposedSurface& accessible, const JudgedSurface& surface,
                               double probe, const Box& world)
    : surface_(surface),
      sphere_of_(accessible.list().id),
      probe_(probe),
      tolerance_(4 * kExposureTolerance * largest_radius(accessible.patches())),
      accessible_(accessible, world),
      curve_tree_(tree_of(surface.curves, world)),
      arc_tree_(tree_of(surface.arcs, world)) {}

void ExcludedFinder::find(std::span<const Vec3d> points, double* found) const {
  std::vector<LeastGap> nearest(points.size());
  accessible_.find_gaps(points, nearest.data());
  measure_all({accessible_.view(), curve_tree_.view(), arc_tree_.view(), surface_.curves,
               surface_.arcs, probe_, tolerance_, surface_, sphere_of_},
              points, nearest.data(), found);
}

void ExcludedFinder::judge(std::span<const Vec3d> points, std::span<const double> reach,
                           JudgedPoint* found) const {
  std::vector<LeastGap> nearest(points.size());
  accessible_.find_gaps(points, nearest.data());
  judge_all({accessible_.view(), curve_tree_.view(), arc_tree_.view(), surface_.curves,
             surface_.arcs, probe_, tolerance_, surface_, sphere_of_},
            points, nearest.data(), reach, found);
}

}  // namespace vdwmesh::excluded
