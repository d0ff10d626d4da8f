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

// The point of a patch that is nearest to p: the formulas of update_nearest().
Vec3d nearest_point(const Patch& patch, const Vec3d& p) {
  const double r = patch.ball.radius;
  const Vec3d y = (1 / r) * (p - patch.ball.center);
  if (has_exposed_foot(patch, p)) {
    const double length = norm(y);
    return patch.ball.center + r * (length > 0 ? (1 / length) * y : Vec3d{1, 0, 0});
  }
  double least = std::numeric_limits<double>::infinity();
  Vec3d nearest{0, 0, 0};
  const auto offer = [&](const Vec3d& direction) {
    const double found = squared_norm(y - direction);
    if (!(found < least)) return;
    least = found;
    nearest = direction;
  };
  for (std::uint32_t i = 0; i < patch.circles; ++i) {
    const arcs::Cap& cap = patch.covers[i].cap;
    const Vec3d radial = y - dot(cap.axis, y) * cap.axis;
    const double length = norm(radial);
    const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    // On the axis all points of the circle are equally near; arcs that are not whole circles offer
    // their ends as corners.
    const Vec3d out = length > 0 ? (1 / length) * radial : arcs::frame_of(cap.axis).first;
    const Vec3d direction = cap.cosine * cap.axis + radius * out;
    if (is_exposed(patch, direction, i)) offer(direction);
  }
  for (std::uint32_t i = 0; i < patch.corner_count; ++i) offer(patch.corners[i].position);
  return patch.ball.center + r * nearest;
}

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

// A tree needs a primitive. Without curves it gets one that no search is made for.
std::uint32_t at_least_one(std::size_t count) {
  return static_cast<std::uint32_t>(std::max<std::size_t>(count, 1));
}

// What a search looks at; owns nothing.
struct Searched {
  PatchTreeView accessible;
  BoxTreeView tree;  // of the curves
  std::span<const SharpCurve> curves;
  double probe, tolerance;  // Å
};

// The distance to the nearest curve, Å, if that is below `bound`; otherwise the bound. A curve as
// near as `least` ends the search.
double distance_to_curves(const Searched& s, const Vec3d& point, double least, double bound) {
  double squared = bound * bound, nearest = squared;
  visit_nearest(s.tree, s.tree.query(point), squared, [&](std::uint32_t i, double& best) {
    nearest = std::min(nearest, squared_distance(s.curves[i], point));
    best = nearest <= least * least ? -1 : nearest;
  });
  return std::sqrt(nearest);
}

// Whether no probe reaches z (see the header). `accessible` is σ, `hint` a patch near by.
bool is_foot_of_solid(const Searched& s, const Vec3d& point, double accessible,
                      std::uint32_t hint) {
  const PatchTreeView& view = s.accessible;
  std::uint32_t owner = hint;
  double squared = accessible * accessible * (1 + kSquareMargin);
  visit_nearest(view.tree, view.tree.query(point), squared, [&](std::uint32_t i, double& best) {
    if (update_nearest(view.patches[i], point, best)) owner = i;
  });
  const Vec3d x = nearest_point(view.patches[owner], point);
  const Vec3d to = point - x;
  const double length = norm(to);
  if (!(length > 0)) return true;
  const Vec3d z = x + (s.probe / length) * to;
  return signed_distance(view, z, find_least_gap(view, z, owner)) <= s.tolerance - s.probe;
}

// The signed distance of a point whose grown ball of least gap is known, Å.
double distance_of(const Searched& s, const Vec3d& point, const LeastGap& nearest) {
  const double to_atom = nearest.gap + s.probe;
  if (is_settled(s.accessible, point, nearest)) return to_atom;
  const double accessible = unsettled_distance(s.accessible, point, nearest);
  const double least = accessible + s.probe;
  if (!(least > 0) || s.curves.empty()) return least;
  const double bound = std::min(to_atom, s.probe);
  const double to_curves = distance_to_curves(s, point, least, bound);
  if (!(to_curves > least) || !(to_curves < bound)) return least;
  return is_foot_of_solid(s, point, accessible, nearest.patch) ? least : to_curves;
}

VDWMESH_MULTIVERSION void measure_all(const Searched& s, std::span<const Vec3d> points,
                                      const LeastGap* nearest, double* found) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    found[i] = distance_of(s, points[i], nearest[i]);
  }
}

}  // namespace

// Points count as reached by a probe if they are deeper in it than the accessible surface, whose
// radii may be wrong by kExposureTolerance, lets be decided.
ExcludedFinder::ExcludedFinder(const ExposedSurface& accessible, std::span<const SharpCurve> curves,
                               double probe, const Box& world)
    : curves_(curves),
      probe_(probe),
      tolerance_(4 * kExposureTolerance * largest_radius(accessible.patches())),
      accessible_(accessible, world),
      tree_(at_least_one(curves.size()), world, [&](std::uint32_t i) {
        return i < curves.size() ? within(box_of(curves[i]), world) : Box{world.lower, world.lower};
      }) {}

void ExcludedFinder::find(std::span<const Vec3d> points, double* found) const {
  std::vector<LeastGap> nearest(points.size());
  accessible_.find_gaps(points, nearest.data());
  measure_all({accessible_.view(), tree_.view(), curves_, probe_, tolerance_}, points,
              nearest.data(), found);
}

}  // namespace vdwmesh::excluded
