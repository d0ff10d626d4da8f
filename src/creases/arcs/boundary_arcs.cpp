// Computes centre, radius and angle of each exposed arc of the union's boundary. Arcs that are too
// small for coordinates in double become points, and whole circles that are too small vanish.
//
// Steps: (1) Each arc of the ExposedBoundary gets the frame of its circle and its sweep, the angle
// that it turns. Each corner is computed once, from its three spheres, and shared by its arcs. Arcs
// that are short or lie on a tiny circle are left out here; the ends of such an arc are noted as
// one point. (2) Circles of one ball that touch get a common corner (touching_arcs.cpp). (3) Pairs
// of corners of one ball that coincide within FeatureSizes::arc are noted as one point. (4)
// Union-find merges all corners that were noted as one point. This may merge the two ends of a
// further short arc, which was a little too long to be left out in step (1); such arcs are removed.
// (5) Patches without width are closed until there is none left.
#include "creases/arcs/boundary_arcs.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "complex/boundary/arc_angle.hpp"
#include "complex/placed_balls.hpp"
#include "complex/simplex_shape.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"
#include "core/steps.hpp"
#include "measures/exposed_boundary.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

// Two corners are joined if they are no farther apart than FeatureSizes::arc times the radius of a
// ball on which both lie. Pairs form chains, so two corners of one set can be farther apart than
// that. An arc between corners of one set becomes a point if its length is at most kJoinAllowance
// times FeatureSizes::arc times the larger radius of its two balls. The factor is an allowance for
// chains, not a proven bound. A longer arc stays: it is a loop from the merged corner to itself.
constexpr double kJoinAllowance = 4;

using Pair = std::array<std::uint32_t, 2>;

// All pairs i < j of `count` points, ascending, that are no farther apart than `reach`. They all
// lie on one sphere of the radius `radius`, but for rounding, and `reach` is a tiny part of it.
// Close points have close projections to any line. So the points are sorted along a line, which
// has a direction that no symmetry of molecules and lattices has, and each one is compared with the
// few that follow it closely.
template <class PointOf>
std::vector<Pair> close_pairs(std::size_t count, const PointOf& point, double reach, double radius,
                              Steps& steps) {
  if (count < 2) return {};
  const Vec3d line{0.3946, 0.5622, 0.7266};
  std::vector<std::pair<double, std::uint32_t>> places(count);  // along the line, and the point
  for (std::uint32_t i = 0; i < count; ++i) {
    places[i] = {dot(point(i) - point(0), line), i};
  }
  std::ranges::sort(places, {}, [](const auto& place) { return place.first; });
  constexpr double kRounding = 1e-14;  // of the radius: of the projections
  const double window = reach + kRounding * radius;
  std::vector<Pair> found;
  for (auto a = places.begin(); a != places.end(); ++a) {
    steps.add(1);
    for (auto b = a + 1; b != places.end() && b->first - a->first <= window; ++b) {
      steps.add(1);
      const auto [i, j] = std::minmax(a->second, b->second);
      if (squared_norm(point(j) - point(i)) <= reach * reach) found.push_back({i, j});
    }
  }
  std::ranges::sort(found);
  return found;
}

// Builds the result step by step; run() lists the steps.
class BoundaryBuilder {
 public:
  BoundaryBuilder(const PlacedBalls& balls, const ExposedBoundary& exposed,
                  const FeatureSizes& sizes, Monitor* monitor)
      : placed_(balls), exposed_(exposed), monitor_(monitor) {
    out_.sizes = sizes;
  }

  BoundaryArcs run() && {
    place_arcs();
    find_touching_arcs();
    find_coincident_corners();
    join_corners();
    // Closing a slit, a patch without width, can leave another one. close_slits() returns whether
    // it closed any; it then has removed an arc, so the loop ends.
    while (close_slits()) {
    }
    return std::move(out_);
  }

 private:
  const Sphere& ball(std::uint32_t i) const { return placed_.balls[i]; }

  // Step (1).
  void place_arcs() {
    out_.corners.resize(exposed_.corners.size());
    for_each_index(out_.corners.size(),
                   [&](std::size_t c) { out_.corners[c] = corner(exposed_.corners[c]); });
    out_.arcs.resize(exposed_.arcs.size());
    for_each_index(out_.arcs.size(),
                   [&](std::size_t a) { out_.arcs[a] = placed(exposed_.arcs[a]); });
    leave_out_arcs();
  }

  // Side 0 is above the plane of a, b and c: where the three are seen counter-clockwise.
  BoundaryCorner corner(const ExposedCorner& exposed) const {
    const auto& [a, b, c] = exposed.balls;
    const CommonPoints points = common_points(ball(a), ball(b), ball(c));
    return {ball(a).center + (exposed.side == 0 ? points.above : points.below), exposed.balls};
  }

  // Computes the frame and the sweep of one arc. The frame is the centre of the circle and two
  // vectors as long as its radius: `cosine` points to angle 0, and `sine` a quarter turn further,
  // as BoundaryArc::at() wants them. Angle 0 is at the arc's first corner; on a whole circle it
  // is anywhere.
  BoundaryArc placed(const CornerArc& exposed) const {
    const Sphere &a = ball(exposed.balls[0]), &b = ball(exposed.balls[1]);
    const EdgeShape shape = edge_shape(a, b);
    const Vec3d axis = (1 / shape.length) * (b.center - a.center);
    // Members: balls, ends, center, cosine, sine, sweep, radius. Those that are empty or 0 here are
    // set below.
    BoundaryArc arc{exposed.balls,
                    exposed.corners,
                    a.center + shape.height[0] * axis,
                    {},
                    {},
                    0,
                    std::sqrt(shape.squared_circle_radius)};
    // On a small circle the corners are too near the centre for their positions to give the angle
    // between them (arc_angle.hpp). kSmallCircle = 1e-6 is a ratio of squared radii: a circle is
    // small up to 1e-3 of the radius of its smaller ball. That is far above FeatureSizes::circle,
    // up to which is_left_out() drops a circle.
    const bool small =
        shape.squared_circle_radius < kSmallCircle * std::pow(std::min(a.radius, b.radius), 2);
    Vec3d out = any_orthogonal(axis);
    if (exposed.is_circle()) {
      arc.sweep = 2 * std::numbers::pi;
      // If atoms stand on a lattice, as in crystals, circles touch each other in the directions of
      // the coordinate axes. The first vertex of a whole circle is turned away from there by 1 rad,
      // so that two circles have no vertex in the point where they touch.
      out = std::cos(1.0) * out + std::sin(1.0) * cross(axis, out);
    } else {
      const Vec3d p = out_.corners[arc.ends[0]].position - arc.center,
                  q = out_.corners[arc.ends[1]].position - arc.center;
      const Vec3d radial = p - dot(p, axis) * axis;
      // Rounding puts the corner slightly off the circle's plane; `radial` is its part in the
      // plane. If that is zero, the circle is tiny, and any direction in its plane will do.
      if (norm(radial) > 0) out = (1 / norm(radial)) * radial;
      arc.sweep = sweep(exposed, axis, p, q, small);
    }
    arc.cosine = arc.radius * out;
    arc.sine = arc.radius * cross(axis, out);
    return arc;
  }

  // The angle from corner p to corner q, counter-clockwise about the axis. Both corners are given
  // relative to the circle's centre. `small` says whether the circle is below kSmallCircle.
  //
  // As a rule the positions of the corners give the angle. On a small circle, the dihedral angles
  // of the triangulation give it instead (arc_angle.hpp). If the positions give an angle below
  // kSmallArc, they cannot tell an arc of almost no length from an arc of almost a whole turn, and
  // the dihedral angles decide between the two. Rounding may have changed the sign of the small
  // angle, so an arc of almost no length gets its absolute value. An arc of almost a whole turn
  // gets 2 pi plus the angle, which may exceed 2 pi by a rounding error.
  double sweep(const CornerArc& arc, const Vec3d& axis, const Vec3d& p, const Vec3d& q,
               bool small) const {
    if (small) return angle_by_dihedrals(arc);
    const double angle = std::atan2(triple_product(axis, p, q), dot(p, q));
    if (std::abs(angle) >= kSmallArc) return angle < 0 ? angle + 2 * std::numbers::pi : angle;
    return angle_by_dihedrals(arc) > std::numbers::pi ? 2 * std::numbers::pi + angle
                                                      : std::abs(angle);
  }

  double angle_by_dihedrals(const CornerArc& arc) const {
    return vdwmesh::angle_by_dihedrals(placed_.balls, arc.balls,
                                       exposed_.corners[arc.corners[0]].balls,
                                       exposed_.corners[arc.corners[1]].balls);
  }

  // Leaves out the arcs that are too small, and counts them. The ends of an arc that becomes a
  // point are kept, for join_corners().
  void leave_out_arcs() {
    const std::vector<std::uint32_t> gone =
        arcs_with([&](const BoundaryArc& arc) { return is_left_out(arc); });
    for (const std::uint32_t a : gone) {
      const BoundaryArc& arc = out_.arcs[a];
      if (arc.is_circle()) {
        ++out_.contacts;
      } else {
        ++out_.points;
        short_arc_ends_.push_back(arc.ends);
      }
    }
    remove(gone);
  }

  // Whether an arc is too small. Both feature sizes refer to the lesser radius of its two balls. A
  // circle is a contact if its radius is at most FeatureSizes::circle times that: the two balls all
  // but touch there. A whole circle that is a contact vanishes. An arc becomes a point if it is
  // short, or if its circle is a contact, however far the arc turns.
  bool is_left_out(const BoundaryArc& arc) const {
    const double smaller_radius = std::min(ball(arc.balls[0]).radius, ball(arc.balls[1]).radius);
    return out_.is_contact(arc.radius, smaller_radius) ||
           (!arc.is_circle() && arc.sweep * arc.radius <= out_.sizes.arc * smaller_radius);
  }

  // The arcs for which the predicate holds, ascending. As a rule there is none.
  template <class Predicate>
  std::vector<std::uint32_t> arcs_with(const Predicate& holds) const {
    return collect<std::uint32_t>(out_.arcs.size(),
                                  [&](std::size_t a, std::vector<std::uint32_t>& found) {
                                    if (holds(out_.arcs[a]))
                                      found.push_back(static_cast<std::uint32_t>(a));
                                  });
  }

  // Removes arcs, given ascending.
  void remove(const std::vector<std::uint32_t>& gone) {
    if (gone.empty()) return;
    auto next = gone.begin();
    std::size_t kept = *next;
    for (std::size_t a = kept; a < out_.arcs.size(); ++a) {
      if (next != gone.end() && *next == a) {
        ++next;
      } else {
        out_.arcs[kept++] = out_.arcs[a];
      }
    }
    out_.arcs.resize(kept);
  }

  // Finds pairs of corners of one ball that coincide: there, boundary curves of one patch meet in a
  // point. The distance counts in fractions of the ball's radius, as on the unit sphere on which
  // the patch is meshed.
  void find_coincident_corners() {
    SortedRows<std::uint32_t> corners;  // by ball: those on its sphere
    corners.fill(placed_.balls.size(), out_.corners.size(), [&](std::size_t c, const auto& add) {
      for (const std::uint32_t b : out_.corners[c].balls) add(b, static_cast<std::uint32_t>(c));
    });
    const auto find = [&](std::size_t b, std::vector<Pair>& found) {
      const auto of_ball = corners[b];
      const auto position = [&](std::size_t i) { return out_.corners[of_ball[i]].position; };
      const double radius = placed_.balls[b].radius;
      Steps steps(monitor_);
      for (const auto& [i, j] :
           close_pairs(of_ball.size(), position, out_.sizes.arc * radius, radius, steps)) {
        found.push_back({of_ball[i], of_ball[j]});
      }
    };
    const auto coincident = collect<Pair>(corners.size(), find, monitor_);
    joined_.insert(joined_.end(), coincident.begin(), coincident.end());
  }

  // Whether an arc has become a point by merging: both its ends are one corner, and the arc is
  // short. An arc whose ends are one corner may also run around most of its circle; it is a loop
  // and stays. The larger radius counts here, because find_coincident_corners() may have joined the
  // ends by the radius of either ball.
  bool is_point(const BoundaryArc& arc, DisjointSets& sets) const {
    if (arc.is_circle() || sets.find(arc.ends[0]) != sets.find(arc.ends[1])) return false;
    const double reach =
        out_.sizes.arc * std::max(ball(arc.balls[0]).radius, ball(arc.balls[1]).radius);
    return arc.sweep * arc.radius <= kJoinAllowance * reach;
  }

  // Gives touching circles a common corner. join_touching_arcs() cuts arcs and appends corners for
  // this, and returns pairs of corners that are one point. If it did either, more than three
  // spheres may pass through a corner (has_joined_corners).
  void find_touching_arcs() {
    const std::size_t corners = out_.corners.size();  // before
    const auto joined = join_touching_arcs(placed_, out_, monitor_);
    joined_.insert(joined_.end(), joined.begin(), joined.end());
    out_.has_joined_corners = corners < out_.corners.size() || !joined.empty();
  }

  // Replaces each set of joined corners by its member of lowest index, which is what
  // DisjointSets::find() returns; threads may call it at the same time. Removes the arcs that have
  // become points. Numbers the corners anew, in their order; corners in which no arc ends any more
  // are dropped. `joins` counts the pairs of joined_ that were not in one set before. The pairs of
  // short_arc_ends_ are not counted, because leave_out_arcs() has counted their arcs in `points`.
  // As a rule there is nothing to join; then every corner ends three arcs and stays.
  void join_corners() {
    out_.has_joined_corners =
        out_.has_joined_corners || !short_arc_ends_.empty() || !joined_.empty();
    if (!out_.has_joined_corners) return;
    DisjointSets sets(out_.corners.size());
    for (const auto& [a, b] : short_arc_ends_) sets.join(a, b);
    for (const auto& [a, b] : joined_) {
      out_.joins += sets.find(a) != sets.find(b);
      sets.join(a, b);
    }
    remove(arcs_with([&](const BoundaryArc& arc) { return is_point(arc, sets); }));
    std::vector<std::uint8_t> is_end(out_.corners.size(), 0);  // of an arc
    for_each_index(out_.arcs.size(), [&](std::size_t a) {
      if (out_.arcs[a].is_circle()) return;
      for (const std::uint32_t end : out_.arcs[a].ends) {
        std::atomic_ref(is_end[sets.find(end)]).store(1, std::memory_order_relaxed);
      }
    });
    // By old index of a corner: its new index, or kNoIndex if no arc ends there.
    std::vector<std::uint32_t> number(out_.corners.size(), kNoIndex);
    const std::size_t count = number_all(
        number.size(), [&](std::size_t c) { return is_end[c] != 0; },
        [&](std::size_t c, std::uint32_t n) { number[c] = n; });
    Buffer<BoundaryCorner> kept(count);
    for_each_index(number.size(), [&](std::size_t c) {
      if (number[c] != kNoIndex) kept[number[c]] = out_.corners[c];
    });
    for_each_index(out_.arcs.size(), [&](std::size_t a) {
      BoundaryArc& arc = out_.arcs[a];
      if (arc.is_circle()) return;
      for (std::uint32_t& end : arc.ends) end = number[sets.find(end)];
    });
    out_.corners = std::move(kept);
  }

  // Closes slits. A slit is a patch without width: two other balls meet the ball in the same circle
  // from opposite sides, so that nothing of its sphere shows between them. The two arcs beside the
  // slit have the same ends and coincide in space. They become one arc between the two other balls.
  // Returns whether a slit was closed.
  bool close_slits() {
    const std::vector<Slit> slits = find_slits();
    // An arc takes part in one closure per call. Afterwards arc a has another ball and arc b is
    // gone, so the other slits with them are out of date; the next call finds those that are left.
    std::vector<std::uint8_t> changed(slits.empty() ? 0 : out_.arcs.size(), 0);
    std::vector<std::uint32_t> gone;
    for (const auto& [ball, a, b] : slits) {
      if (changed[a] || changed[b]) continue;
      // Arc a takes the ball on the far side of arc b in place of `ball`. Its frame can stay: its
      // axis runs from its first ball to its second, and as the three centres are in line with
      // `ball` in the middle (is_slit()), the axis towards the outer ball has the same direction.
      (out_.arcs[a].balls[0] == ball ? out_.arcs[a].balls[0] : out_.arcs[a].balls[1]) =
          other_ball(out_.arcs[b], ball);
      changed[a] = changed[b] = 1;
      gone.push_back(b);
    }
    std::sort(gone.begin(), gone.end());
    remove(gone);
    out_.joins += gone.size();  // BoundaryArcs::joins counts closed slits too
    out_.has_joined_corners = out_.has_joined_corners || !gone.empty();
    return !gone.empty();
  }

  struct Slit {
    std::uint32_t ball, first, second;  // the two arcs
  };

  // All pairs of arcs that bound a slit, by ball.
  std::vector<Slit> find_slits() const {
    // An arc of a ball, with its ends in ascending order. In the row of a ball, arcs with the same
    // ends follow each other. So do all whole circles, whose ends are kNoIndex.
    struct ArcBetween {
      std::uint32_t low, high, arc;
      auto operator<=>(const ArcBetween&) const = default;
    };
    SortedRows<ArcBetween> places;
    places.fill(placed_.balls.size(), out_.arcs.size(), [&](std::size_t a, const auto& add) {
      const BoundaryArc& arc = out_.arcs[a];
      const auto [low, high] = std::minmax(arc.ends[0], arc.ends[1]);
      for (const std::uint32_t b : arc.balls) add(b, {low, high, static_cast<std::uint32_t>(a)});
    });
    const auto find = [&](std::size_t b, std::vector<Slit>& found) {
      const auto row = std::as_const(places)[b];
      Steps steps(monitor_);
      for (auto i = row.begin(); i != row.end();) {
        const auto end = std::find_if(
            i, row.end(), [&](const auto& p) { return p.low != i->low || p.high != i->high; });
        find_slits(static_cast<std::uint32_t>(b), std::span(i, end), steps, found);
        i = end;
      }
    };
    return collect<Slit>(places.size(), find, monitor_);
  }

  // The same for arcs of one ball that have the same ends. Arcs beside a slit have close middles.
  template <class Places>
  void find_slits(std::uint32_t ball_index, const Places& arcs, Steps& steps,
                  std::vector<Slit>& found) const {
    if (arcs.size() < 2) return;
    const auto middle = [&](std::size_t i) {
      const BoundaryArc& arc = out_.arcs[arcs[i].arc];
      return arc.is_circle() ? arc.center : arc.at(arc.sweep / 2);
    };
    constexpr double kRounding = 1e-6;  // of the reach: is_slit() decides
    const double radius = ball(ball_index).radius,
                 reach = (1 + kRounding) * out_.sizes.arc * radius;
    for (const auto& [i, j] : close_pairs(arcs.size(), middle, reach, radius, steps)) {
      if (is_slit(ball_index, out_.arcs[arcs[i].arc], out_.arcs[arcs[j].arc])) {
        found.push_back({ball_index, arcs[i].arc, arcs[j].arc});
      }
    }
  }

  // The ball on the other side of an arc. Precondition: `ball` is one of its two balls.
  static std::uint32_t other_ball(const BoundaryArc& arc, std::uint32_t ball) {
    return arc.balls[arc.balls[0] == ball ? 1 : 0];
  }

  // Whether two arcs of the ball that have the same ends bound a slit. The two other balls must be
  // different and lie on opposite sides of this ball, and the arcs must be no farther apart than
  // FeatureSizes::arc of the ball's radius. For arcs with ends it is enough to compare their
  // midpoints, since the arcs then agree in three points. For whole circles, the sum below bounds
  // the distance of any point of one circle from the other: the distance of the centres, the
  // difference of the radii, and the radius times the sine of the angle between the planes.
  bool is_slit(std::uint32_t ball_index, const BoundaryArc& a, const BoundaryArc& b) const {
    const Sphere& s = ball(ball_index);
    const Vec3d to_a = ball(other_ball(a, ball_index)).center - s.center,
                to_b = ball(other_ball(b, ball_index)).center - s.center;
    if (!(dot(to_a, to_b) < 0) || other_ball(a, ball_index) == other_ball(b, ball_index))
      return false;
    const double reach = out_.sizes.arc * s.radius;
    if (!a.is_circle()) return norm(a.at(a.sweep / 2) - b.at(b.sweep / 2)) <= reach;
    const double tilt = norm(cross(to_a, to_b)) / (norm(to_a) * norm(to_b));
    return norm(a.center - b.center) + std::abs(a.radius - b.radius) + a.radius * tilt <= reach;
  }

  const PlacedBalls& placed_;
  const ExposedBoundary& exposed_;
  Monitor* const monitor_;
  BoundaryArcs out_;
  // Pairs of corners that are one point, as indices into out_.corners. short_arc_ends_ has the ends
  // of arcs that were left out, joined_ the pairs found by touching or by position.
  std::vector<std::array<std::uint32_t, 2>> short_arc_ends_, joined_;
};

}  // namespace

BoundaryArcs boundary_arcs(const PlacedBalls& balls, const ExposedBoundary& exposed,
                           const FeatureSizes& sizes, Monitor* monitor) {
  return BoundaryBuilder(balls, exposed, sizes, monitor).run();
}

}  // namespace vdwmesh
