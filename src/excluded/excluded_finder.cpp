// ExcludedFinder: the distance to the accessible surface decides for most points; for the others
// the nearest crease or cusp is searched.
//
// An accessible point f nearest to a point q inside of a grown ball is on an arc, or it is the foot
// of q on the ball of least gap. For let f be inside of a patch of ball i. If q is outside of ball
// i, so is all of the way from q to f, and just before f it runs inside of another ball, whose
// sphere f is on then: f is on an arc. If q is inside, no other ball j contains f, so |q - c_j| >=
// R_j - |q - f|: the gap of i is the least. So one test of that foot, and one search of the arcs,
// find the distance.
//
// The tests are ordered by their cost. If that foot is exposed, z is a point of an atom, which no
// probe reaches. A point farther from all curves than from the nearest atom has its nearest point
// elsewhere.
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

// The point of an arc that is nearest to a point.
struct OnArc {
  double squared;  // Å²
  std::uint32_t arc = kNoIndex;
};

// The nearest point of all arcs, if its squared distance is below `bound`. None is nearer than
// `least`, so one that is as near ends the search. The arc `hint` is measured first.
OnArc nearest_on_arcs(const Searched& s, const Vec3d& point, double least, double bound,
                      std::uint32_t hint) {
  OnArc found{bound};
  if (s.arcs.empty()) return found;
  const auto offer = [&](std::uint32_t i) {
    const double squared = s.arcs[i].squared_distance(point);
    if (squared < found.squared) found = {squared, i};
  };
  offer(hint);
  double squared = found.squared;
  visit_nearest(s.arc_tree, s.arc_tree.query(point), squared, [&](std::uint32_t i, double& best) {
    offer(i);
    best = found.squared <= least ? -1 : found.squared;
  });
  return found;
}

// Whether no probe reaches z (see the header), the point of the ray from x, of an arc.
bool is_foot_of_solid(const Searched& s, const Vec3d& point, const OnArc& nearest,
                      const LeastGap& least) {
  const Vec3d x = s.arcs[nearest.arc].nearest_point(point), to = point - x;
  const double length = norm(to);
  if (!(length > 0)) return true;
  const Vec3d z = x + (s.probe / length) * to;
  const LeastGap at_z = find_least_gap(s.accessible, z, least.patch);
  const double inside = s.probe - s.tolerance;
  if (-at_z.gap >= inside) return true;
  if (is_settled(s.accessible, z, at_z)) return false;
  return nearest_on_arcs(s, z, 0, inside * inside, nearest.arc).squared >= inside * inside;
}

// The signed distance of a point whose grown ball of least gap is known, Å. `hint` is an arc, and
// becomes the nearest one.
double distance_of(const Searched& s, const Vec3d& point, const LeastGap& least,
                   std::uint32_t& hint) {
  const double to_atom = least.gap + s.probe;
  if (is_settled(s.accessible, point, least)) return to_atom;
  const double squared_gap = least.gap * least.gap;
  const OnArc nearest =
      nearest_on_arcs(s, point, squared_gap, std::numeric_limits<double>::infinity(), hint);
  if (nearest.arc != kNoIndex) hint = nearest.arc;
  const double shortest = s.probe - std::sqrt(std::max(nearest.squared, squared_gap));
  if (!(shortest > 0) || s.curves.empty()) return shortest;
  const double bound = std::min(to_atom, s.probe);
  const double to_curves = distance_to_curves(s, point, shortest, bound);
  if (!(to_curves > shortest) || !(to_curves < bound)) return shortest;
  return is_foot_of_solid(s, point, nearest, least) ? shortest : to_curves;
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
