// Finds circles of one ball that all but touch, and cuts their arcs at the point of touching.
//
// Another ball covers a cap of a ball's sphere, and the rim of the cap is a circle. Two circles
// touch from outside if their caps touch without overlapping.
//
// Steps: (1) All arcs are sorted by ball and by the ball on their other side, so that the arcs of
// one circle follow each other. (2) For each ball, pairs of its circles are tested on the unit
// sphere about its centre: all pairs of few circles, and of many those that have arcs near each
// other. If the circles touch from outside and both have an exposed arc at the
// point, the point becomes a corner, and a cut of these arcs is noted. (3) An arc belongs to two
// balls, and both may find the same point of it; such cuts are merged. (4) The arcs are cut.
// boundary_arcs.cpp calls join_touching_arcs() before it merges corners.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>

#include "complex/placed_balls.hpp"
#include "complex/simplex_shape.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"
#include "core/steps.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "spheres/cell_list.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

// Two circles are taken for parallel if the angle (rad) between their axes, or between one axis and
// the other reversed, is less than this. If parallel circles are close to each other at all, they
// are close all around, so there is no single point to cut. boundary_arcs.cpp closes such slits.
constexpr double kParallel = 1e-6;

// All pairs of so many circles are tested.
constexpr std::size_t kFewCircles = 64;

// A circle on the unit sphere about the centre of a ball, namely the rim of what another ball
// covers.
struct RimCircle {
  // Unit, towards the other ball.
  Vec3d axis;
  // Cosine and sine of the circle's angular radius, seen from the centre of the ball. The cosine is
  // negative if the other ball covers more than half the sphere.
  double cosine, sine;
  // The ball that shares the circle.
  std::uint32_t other;
  // Its exposed arcs: entries first .. first + count - 1 of ball_arcs_.
  std::size_t first, count;
};

// Two circles of a ball that touch in a direction from its centre, a unit vector.
struct Touch {
  std::uint32_t ball;
  std::array<RimCircle, 2> circles;
  Vec3d point;
};

// An arc as seen from one of its balls; `other` is its other ball. Each arc has two entries.
struct ArcOfBall {
  std::uint32_t ball, other, arc;
  friend auto operator<=>(const ArcOfBall&, const ArcOfBall&) = default;
};

// A point at which an arc is to be cut.
struct Cut {
  // Index into BoundaryArcs::arcs.
  std::uint32_t arc;
  // Angle of the point on the arc, as in BoundaryArc, rad.
  double angle;
  // Index into BoundaryArcs::corners; kNoIndex until the corner is known.
  std::uint32_t corner;
};

class TouchingArcs {
 public:
  TouchingArcs(const PlacedBalls& balls, BoundaryArcs& boundary, Monitor* monitor)
      : t_(balls), out_(boundary), monitor_(monitor) {}

  std::vector<std::array<std::uint32_t, 2>> run() && {
    list_arcs();
    // The search changes nothing, so all balls can be searched at once.
    const auto search = [&](std::size_t i, std::vector<Touch>& found) {
      if (i == 0 || ball_arcs_[i].ball != ball_arcs_[i - 1].ball) search_ball(i, found);
    };
    const std::vector<Touch> touches = collect<Touch>(ball_arcs_.size(), search, monitor_);
    for (const Touch& t : touches) touch(t.ball, t.circles[0], t.circles[1], t.point);
    join_cuts();
    cut_arcs();
    return std::move(joined_);
  }

 private:
  // Step (1).
  void list_arcs() {
    rows_.fill(t_.balls.size(), out_.arcs.size(), [&](std::size_t a, const auto& add) {
      const auto [first, second] = out_.arcs[a].balls;
      add(first, {first, second, static_cast<std::uint32_t>(a)});
      add(second, {second, first, static_cast<std::uint32_t>(a)});
    });
    ball_arcs_ = rows_.entries();
  }

  // Step (2) for one ball: gathers its circles from its entries of ball_arcs_, from `begin` on, and
  // tests pairs. Entries with the same other ball are arcs of one circle.
  void search_ball(std::size_t begin, std::vector<Touch>& found) const {
    const std::uint32_t ball = ball_arcs_[begin].ball;
    std::vector<RimCircle> circles;
    for (std::size_t i = begin; i < ball_arcs_.size() && ball_arcs_[i].ball == ball; ++i) {
      if (i > begin && ball_arcs_[i].other == ball_arcs_[i - 1].other) {
        ++circles.back().count;
      } else {
        circles.push_back(circle_at(i));
      }
    }
    const auto test = [&](std::size_t i, std::size_t j) {
      if (const auto point = touching_point(circles[i], circles[j]))
        found.push_back({ball, {circles[i], circles[j]}, *point});
    };
    if (circles.size() > kFewCircles) {
      for (const auto& [i, j] : near_circles(ball, circles)) test(i, j);
      return;
    }
    for (std::size_t i = 0; i < circles.size(); ++i) {
      for (std::size_t j = i + 1; j < circles.size(); ++j) test(i, j);
    }
  }

  // Pairs i < j of circles, ascending, with all those that touch() does not pass over: such circles
  // have arcs that come within `reach` of one point. Each arc gets a ball around it, in radii of
  // the ball that it lies on, and pairs of these balls that meet are found in a list of cells.
  std::vector<std::array<std::uint32_t, 2>> near_circles(std::uint32_t ball,
                                                         std::span<const RimCircle> circles) const {
    const Sphere& s = t_.balls[ball];
    const double reach = std::max(1e-7, 8 * out_.sizes.arc);  // twice that of touch(), and more
    std::vector<Sphere> around;
    std::vector<std::uint32_t> circle_of;
    for (std::uint32_t i = 0; i < circles.size(); ++i) {
      for (std::size_t k = circles[i].first; k < circles[i].first + circles[i].count; ++k) {
        const Sphere of_arc = ball_around(out_.arcs[ball_arcs_[k].arc]);
        around.push_back(
            {(1 / s.radius) * (of_arc.center - s.center), of_arc.radius / s.radius + reach});
        circle_of.push_back(i);
      }
    }
    const CellList list = make_ball_list(SphereSet::view(around));
    const CellListView view = list.view();
    std::vector<std::array<std::uint32_t, 2>> pairs;
    Steps steps(monitor_);
    for (std::uint32_t k = 0; k < around.size(); ++k) {
      const Sphere& a = around[k];
      const Vec3d box{a.radius, a.radius, a.radius};
      visit_near_box(view, a.center - box, a.center + box, [&](ListPlace place) {
        steps.add(1);
        const Sphere& b = view.spheres[place];
        const std::uint32_t i = circle_of[k], j = circle_of[view.id[place]];
        if (i < j && norm(a.center - b.center) <= a.radius + b.radius) pairs.push_back({i, j});
        return false;
      });
    }
    std::ranges::sort(pairs);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  // A ball that has the arc in it, but for rounding: around the centre of its circle, or around its
  // middle, from which its ends are farthest.
  static Sphere ball_around(const BoundaryArc& arc) {
    if (arc.sweep >= std::numbers::pi) return {arc.center, arc.radius};
    return {arc.at(arc.sweep / 2), 2 * arc.radius * std::sin(arc.sweep / 4)};
  }

  // The circle of entry `place` of ball_arcs_, as yet with this arc alone.
  RimCircle circle_at(std::size_t place) const {
    const Sphere &s = t_.balls[ball_arcs_[place].ball], &o = t_.balls[ball_arcs_[place].other];
    const EdgeShape shape = edge_shape(s, o);
    return {(1 / shape.length) * (o.center - s.center),
            shape.height[0] / s.radius,
            std::sqrt(shape.squared_circle_radius) / s.radius,
            ball_arcs_[place].other,
            place,
            1};
  }

  // The point of the unit sphere in which two circles touch from outside, or nothing.
  //
  // Let α and β be the angular radii of the circles and γ the angle between their axes. They touch
  // from outside if γ = α + β. The first test compares the cosines of both sides, with cos(α + β) =
  // cos α cos β - sin α sin β. Circles with a gap of at most FeatureSizes::arc always pass: the gap
  // changes the cosine by no more than itself, and the slack is four times as large.
  //
  // The second test rejects sin(α + β) < 0. Then α + β is more than half a turn, so the two caps
  // overlap, and where cos γ = cos(α + β) the rims touch in a point at the back. The caps cover all
  // the rest of the sphere, so nothing is exposed there.
  //
  // The last test decides: it measures the distance between p and q, the nearest points of the two
  // circles. Both lie in the plane of the two axes.
  std::optional<Vec3d> touching_point(const RimCircle& a, const RimCircle& b) const {
    const double along = dot(a.axis, b.axis);
    const double slack = 4 * out_.sizes.arc;
    if (std::abs(along - (a.cosine * b.cosine - a.sine * b.sine)) > slack) return std::nullopt;
    if (a.sine * b.cosine + a.cosine * b.sine < -slack) return std::nullopt;
    const Vec3d to_b = b.axis - along * a.axis, to_a = a.axis - along * b.axis;
    if (norm(to_b) < kParallel) return std::nullopt;
    const Vec3d p = a.cosine * a.axis + a.sine * unit(to_b),
                q = b.cosine * b.axis + b.sine * unit(to_a);
    if (norm(p - q) > out_.sizes.arc) return std::nullopt;
    return unit(p + q);
  }

  // Records that two circles of a ball touch in a direction from its centre, a unit vector. If one
  // of them has no exposed arc there, a third ball covers the point, and nothing is recorded. Ends
  // of arcs near the point are one corner with it; arcs that pass through it are cut there.
  //
  // An end of an arc is near the point if it is no farther than `reach`. That is more than the
  // distance of the point from either circle, which is about half of FeatureSizes::arc.
  void touch(std::uint32_t ball, const RimCircle& a, const RimCircle& b, const Vec3d& direction) {
    const Sphere& s = t_.balls[ball];
    const BoundaryCorner corner{s.center + s.radius * direction, {ball, a.other, b.other}};
    const double reach = 2 * out_.sizes.arc * s.radius;
    std::vector<std::uint32_t> ends;  // corners within `reach` of the point
    std::vector<Cut> cuts;
    for (const RimCircle& c : {a, b}) {
      const std::size_t before = ends.size() + cuts.size();
      for (std::size_t i = c.first; i < c.first + c.count; ++i)
        find_on_arc(ball_arcs_[i].arc, corner.position, reach, ends, cuts);
      if (ends.size() + cuts.size() == before) return;  // a third ball covers it
    }
    // Without cuts, arcs of both circles end near the point. find_coincident_corners() in
    // boundary_arcs.cpp compares these ends.
    if (cuts.empty()) return;
    ++out_.joins;
    if (ends.empty()) {
      ends.push_back(static_cast<std::uint32_t>(out_.corners.size()));
      out_.corners.push_back(corner);
    }
    for (std::size_t i = 1; i < ends.size(); ++i) joined_.push_back({ends[0], ends[i]});
    for (Cut& cut : cuts) {
      cut.corner = ends[0];
      cuts_.push_back(cut);
    }
  }

  // Finds the point on an arc. If an end of the arc lies within `reach` of the point, that corner
  // is added to `ends`. If the point lies inside the arc, a cut is added to `cuts`. Otherwise the
  // arc does not contain the point.
  void find_on_arc(std::uint32_t index, const Vec3d& point, double reach,
                   std::vector<std::uint32_t>& ends, std::vector<Cut>& cuts) const {
    const BoundaryArc& arc = out_.arcs[index];
    if (!arc.is_circle()) {
      for (const std::uint32_t end : arc.ends) {
        if (norm(out_.corners[end].position - point) <= reach) {
          ends.push_back(end);
          return;
        }
      }
    }
    const Vec3d d = point - arc.center;
    double angle = std::atan2(dot(d, arc.sine), dot(d, arc.cosine));
    if (angle < 0) angle += 2 * std::numbers::pi;
    if (angle < arc.sweep) cuts.push_back({index, angle, kNoIndex});
  }

  // Step (3): merges cuts of one arc that coincide, and notes that their corners are one point.
  // After sorting by angle, such cuts are neighbours. On a whole circle the last cut may also
  // coincide with the first. So each cut is compared with the one before it and with the first of
  // its arc. Cuts that stay are moved to the front of cuts_.
  void join_cuts() {
    std::sort(cuts_.begin(), cuts_.end(), [](const Cut& a, const Cut& b) {
      return std::tie(a.arc, a.angle, a.corner) < std::tie(b.arc, b.angle, b.corner);
    });
    std::size_t kept = 0, first = 0;  // first: index of the first cut of the same arc
    for (const Cut& cut : cuts_) {
      if (kept == 0 || cuts_[kept - 1].arc != cut.arc) first = kept;
      const bool again =
          kept > first && (is_same_place(cuts_[kept - 1], cut) || is_same_place(cuts_[first], cut));
      if (again) {
        joined_.push_back(
            {cuts_[is_same_place(cuts_[first], cut) ? first : kept - 1].corner, cut.corner});
      } else {
        cuts_[kept++] = cut;
      }
    }
    cuts_.resize(kept);
  }

  // Whether two cuts of one arc coincide. The corner of a cut lies within 2 × FeatureSizes::arc of
  // the point that its ball has found (touch()), so the corners of two cuts at the same point are
  // at most twice as far apart. FeatureSizes::arc counts in radii of the ball that found the point.
  // It may be either ball of the arc, so the larger radius is taken.
  bool is_same_place(const Cut& a, const Cut& b) const {
    const BoundaryArc& arc = out_.arcs[a.arc];
    const double r = std::max(t_.balls[arc.balls[0]].radius, t_.balls[arc.balls[1]].radius);
    return norm(out_.corners[a.corner].position - out_.corners[b.corner].position) <=
           4 * out_.sizes.arc * r;
  }

  // Step (4).
  void cut_arcs() {
    for (std::size_t begin = 0; begin < cuts_.size();) {
      std::size_t end = begin;
      while (end < cuts_.size() && cuts_[end].arc == cuts_[begin].arc) ++end;
      cut_arc({cuts_.data() + begin, end - begin});
      begin = end;
    }
  }

  // Cuts one arc at `cuts`, which are sorted by angle and not empty. The first part replaces the
  // whole arc in the list, and the others are appended. An arc with n cuts has n + 1 parts. A whole
  // circle has no start of its own, so it has n parts; the last of them ends at the first cut, a
  // full turn later.
  void cut_arc(std::span<const Cut> cuts) {
    const BoundaryArc whole = out_.arcs[cuts[0].arc];
    const bool circle = whole.is_circle();
    const Cut last = circle ? Cut{cuts[0].arc, cuts[0].angle + whole.sweep, cuts[0].corner}
                            : Cut{cuts[0].arc, whole.sweep, whole.ends[1]};
    if (!circle) out_.arcs[cuts[0].arc] = part(whole, {0, 0.0, whole.ends[0]}, cuts[0]);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const BoundaryArc piece = part(whole, cuts[i], i + 1 < cuts.size() ? cuts[i + 1] : last);
      if (circle && i == 0) {
        out_.arcs[cuts[0].arc] = piece;
      } else {
        out_.arcs.push_back(piece);
      }
    }
  }

  // The part of an arc between two cuts; their member `arc` is not used. Its frame, the vectors
  // `cosine` and `sine`, is turned so that angle 0 is at `from`.
  static BoundaryArc part(const BoundaryArc& whole, const Cut& from, const Cut& to) {
    BoundaryArc arc = whole;
    const double c = std::cos(from.angle), s = std::sin(from.angle);
    arc.ends = {from.corner, to.corner};
    arc.cosine = c * whole.cosine + s * whole.sine;
    arc.sine = c * whole.sine - s * whole.cosine;
    arc.sweep = to.angle - from.angle;
    return arc;
  }

  const PlacedBalls& t_;
  BoundaryArcs& out_;
  Monitor* const monitor_;
  SortedRows<ArcOfBall> rows_;            // by ball
  std::span<const ArcOfBall> ball_arcs_;  // of all rows: by ball, then other ball, then arc
  // The cuts of all arcs. join_cuts() sorts them by arc and angle.
  std::vector<Cut> cuts_;
  // Pairs of corners that are one point.
  std::vector<std::array<std::uint32_t, 2>> joined_;
};

}  // namespace

std::vector<std::array<std::uint32_t, 2>> join_touching_arcs(const PlacedBalls& balls,
                                                             BoundaryArcs& boundary,
                                                             Monitor* monitor) {
  return TouchingArcs(balls, boundary, monitor).run();
}

}  // namespace vdwmesh
