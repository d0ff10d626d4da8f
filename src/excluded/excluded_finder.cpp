// ExcludedFinder: the distance to the accessible surface decides for most points; for the others
// the nearest crease or cusp is searched.
//
// The tests are ordered by their cost. If the nearest accessible point is inside a patch, z is a
// point of an atom, which no probe reaches. A point farther from all curves than from the nearest
// atom has its nearest point elsewhere.
#include "excluded/excluded_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/multiversion.hpp"
#include "surface/box.hpp"

namespace vdwmesh::excluded {
namespace {

double largest_radius(std::span<const Patch> patches) {
  double largest = 0;
  for (const Patch& patch : patches) largest = std::max(largest, patch.ball.radius);
  return largest;
}

// A circle may leave the world where its arc does not.
Box within(Box box, const Box& world) {
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = std::max(box.lower[axis], world.lower[axis]);
    box.upper[axis] = std::min(box.upper[axis], world.upper[axis]);
  }
  return box;
}

// A tree needs a primitive. Without arcs it gets one that no search is made for.
BoxTree tree_of(std::span<const CircleArc> arcs, const Box& world) {
  const auto size = static_cast<std::uint32_t>(std::max<std::size_t>(arcs.size(), 1));
  return BoxTree(size, world, [&](std::uint32_t i) {
    return i < arcs.size() ? within(arcs[i].box(), world) : Box{world.lower, world.lower};
  });
}

// What a search looks at; owns nothing.
struct Searched {
  PatchTreeView accessible;
  BoxTreeView curve_tree, arc_tree;
  std::span<const CircleArc> curves, arcs;
  double probe, tolerance;  // Å
};

// The distance to the nearest curve, Å, if that is below `bound`; otherwise the bound. A curve as
// near as `least` ends the search.
double distance_to_curves(const Searched& s, const Vec3d& point, double least, double bound) {
  double squared = bound * bound, nearest = squared;
  visit_nearest(s.curve_tree, s.curve_tree.query(point), squared,
                [&](std::uint32_t i, double& best) {
                  nearest = std::min(nearest, s.curves[i].squared_distance(point));
                  best = nearest <= least * least ? -1 : nearest;
                });
  return std::sqrt(nearest);
}

// An accessible point: of an arc, or the foot on a patch.
struct Accessible {
  double squared;  // Å², from the point searched from
  std::uint32_t arc = kNoIndex, patch = kNoIndex;

  Vec3d place(const Searched& s, const Vec3d& point) const {
    if (arc != kNoIndex) return s.arcs[arc].nearest_point(point);
    const Sphere& ball = s.accessible.balls[patch];
    const Vec3d out = point - ball.center;
    const double length = norm(out);
    return ball.center + ball.radius * (length > 0 ? (1 / length) * out : Vec3d{1, 0, 0});
  }
};

// The accessible point nearest to a point inside of a grown ball, if its squared distance is below
// `bound`. It is a foot or on the border of a patch, which the arcs are. No accessible point is
// nearer than `least`, so one that is as near ends the search. The arc `hint` is measured first.
Accessible nearest_accessible(const Searched& s, const Vec3d& point, double least, double bound,
                              std::uint32_t hint) {
  Accessible found{bound};
  const auto offer_arc = [&](std::uint32_t i) {
    const double squared = s.arcs[i].squared_distance(point);
    if (squared < found.squared) found = {squared, i, kNoIndex};
  };
  if (!s.arcs.empty()) {
    offer_arc(hint);
    double squared = found.squared;
    visit_nearest(s.arc_tree, s.arc_tree.query(point), squared, [&](std::uint32_t i, double& best) {
      offer_arc(i);
      best = found.squared <= least ? -1 : found.squared;
    });
  }
  if (found.squared <= least) return found;
  double squared = found.squared, reach = std::sqrt(squared);
  const PatchTreeView& view = s.accessible;
  visit_nearest(view.tree, view.tree.query(point), squared, [&](std::uint32_t i, double& best) {
    const Sphere& ball = view.balls[i];
    const double square = squared_norm(point - ball.center);
    const double most = ball.radius + reach, fewest = ball.radius - reach;
    if (!(square < most * most) || (fewest > 0 && !(square > fewest * fewest))) return;
    const double gap = std::sqrt(square) - ball.radius;
    if (!(gap * gap < best) || !has_exposed_foot(view.patches[i], point)) return;
    found = {gap * gap, kNoIndex, i};
    best = gap * gap;
    reach = std::abs(gap);
  });
  return found;
}

// Whether no probe reaches z (see the header), the point of the ray from x.
bool is_foot_of_solid(const Searched& s, const Vec3d& point, const Accessible& nearest,
                      const LeastGap& least, std::uint32_t hint) {
  const Vec3d x = nearest.place(s, point), to = point - x;
  const double length = norm(to);
  if (!(length > 0)) return true;
  const Vec3d z = x + (s.probe / length) * to;
  const LeastGap at_z = find_least_gap(s.accessible, z, least.patch);
  const double inside = s.probe - s.tolerance;
  if (!(at_z.gap < 0) || -at_z.gap >= inside) return -at_z.gap >= inside;
  return nearest_accessible(s, z, 0, inside * inside, hint).squared >= inside * inside;
}

// The signed distance of a point whose grown ball of least gap is known, Å. `hint` is an arc, and
// becomes the nearest one.
double distance_of(const Searched& s, const Vec3d& point, const LeastGap& least,
                   std::uint32_t& hint) {
  const double to_atom = least.gap + s.probe;
  if (is_settled(s.accessible, point, least)) return to_atom;
  const double squared_gap = least.gap * least.gap;
  const Accessible nearest =
      nearest_accessible(s, point, squared_gap, std::numeric_limits<double>::infinity(), hint);
  if (nearest.arc != kNoIndex) hint = nearest.arc;
  const double to_accessible = std::sqrt(std::max(nearest.squared, squared_gap));
  const double shortest = s.probe - to_accessible;
  if (!(shortest > 0) || s.curves.empty()) return shortest;
  const double bound = std::min(to_atom, s.probe);
  const double to_curves = distance_to_curves(s, point, shortest, bound);
  if (!(to_curves > shortest) || !(to_curves < bound)) return shortest;
  return is_foot_of_solid(s, point, nearest, least, hint) ? shortest : to_curves;
}

VDWMESH_MULTIVERSION void measure_all(const Searched& s, std::span<const Vec3d> points,
                                      const LeastGap* nearest, double* found) {
  std::uint32_t hint = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    found[i] = distance_of(s, points[i], nearest[i], hint);
  }
}

}  // namespace

// Points count as reached by a probe if they are deeper in it than the accessible surface, whose
// radii may be wrong by kExposureTolerance, lets be decided.
ExcludedFinder::ExcludedFinder(const ExposedSurface& accessible, const JudgedSurface& surface,
                               double probe, const Box& world)
    : curves_(surface.curves),
      arcs_(surface.arcs),
      probe_(probe),
      tolerance_(4 * kExposureTolerance * largest_radius(accessible.patches())),
      accessible_(accessible, world),
      curve_tree_(tree_of(curves_, world)),
      arc_tree_(tree_of(arcs_, world)) {}

void ExcludedFinder::find(std::span<const Vec3d> points, double* found) const {
  std::vector<LeastGap> nearest(points.size());
  accessible_.find_gaps(points, nearest.data());
  measure_all({accessible_.view(), curve_tree_.view(), arc_tree_.view(), curves_, arcs_, probe_,
               tolerance_},
              points, nearest.data(), found);
}

}  // namespace vdwmesh::excluded
