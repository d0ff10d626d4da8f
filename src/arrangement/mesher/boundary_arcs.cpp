// Places the exposed arcs of the dual complex in space and reduces those that are too small.
//
// Steps: (1) Each arc of exposed_arcs() gets the frame of its circle and its sweep, the angle that
// it turns. Each corner is computed once, from its three spheres, and shared by its arcs. Arcs that
// are short or lie on a tiny circle are left out here; the ends of such an arc are noted as one
// point. (2) Circles of one ball that touch get a common corner (touching_arcs.cpp). (3) Pairs of
// corners of one ball that coincide within FeatureSizes::arc are noted as one point. (4) Union-find
// merges all corners that were noted as one point. This may merge the two ends of a further short
// arc, which was a little too long to be left out in step (1); such arcs are removed. (5) Patches
// without width are closed until there is none left.
#include "arrangement/mesher/boundary_arcs.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/complex/arc_angle.hpp"
#include "arrangement/complex/simplex_shape.hpp"
#include "arrangement/directions.hpp"
#include "arrangement/mesher/touching_arcs.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Corners are joined if two of them are closer than FeatureSizes::arc, relative to a radius. Pairs
// form chains, so two corners of one set can be farther apart than that. An arc between corners of
// one set counts as a point up to this multiple of FeatureSizes::arc. The factor is an allowance
// for chains, not a proven bound. A longer arc stays: it is a loop from the merged corner to
// itself.
constexpr double kJoinAllowance = 4;

// Builds the result step by step; run() lists the steps.
class BoundaryBuilder {
 public:
  BoundaryBuilder(const PowerTriangulation& triangulation, const DualComplex& complex,
                  const FeatureSizes& sizes)
      : t_(triangulation), k_(complex), corner_of_(2 * k_.triangles.size(), kNoIndex) {
    out_.sizes = sizes;
  }

  BoundaryArcs run() && {
    place_arcs(exposed_arcs(t_, k_));
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
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  // Step (1). Corners are numbered in the order in which the arcs name them. Corners and arcs are
  // then placed on all cores.
  void place_arcs(const std::vector<ExposedArc>& exposed) {
    std::vector<CornerIndex> named;
    const auto number = [&](CornerIndex index) {
      if (corner_of_[index] != kNoIndex) return;
      corner_of_[index] = static_cast<std::uint32_t>(named.size());
      named.push_back(index);
    };
    for (const ExposedArc& arc : exposed) {
      if (arc.start == kNoCorner) continue;
      number(arc.start);
      number(arc.end);
    }
    out_.corners.resize(named.size());
    for_each_index(named.size(), [&](std::size_t i) { out_.corners[i] = corner(named[i]); });
    out_.arcs.resize(exposed.size());
    for_each_index(exposed.size(), [&](std::size_t i) { out_.arcs[i] = placed(exposed[i]); });
    std::erase_if(out_.arcs, [&](const BoundaryArc& arc) { return leave_out(arc); });
  }

  // A corner of the dual complex. A CornerIndex is 2 × triangle + side. Side 0 lies above the
  // triangle: its vertices a, b, c are counter-clockwise seen from there. Side 1 lies below.
  BoundaryCorner corner(CornerIndex index) const {
    const DualTriangle& f = k_.triangles[index / 2];
    const Sphere& a = ball(f.vertices[0]);
    const CommonPoints points = common_points(a, ball(f.vertices[1]), ball(f.vertices[2]));
    return {a.center + (index % 2 == 0 ? points.above : points.below), f.vertices};
  }

  // Computes the frame and the sweep of one arc. The frame is the centre of
  // the circle and two vectors, `cosine` in the direction `out` of angle 0 and `sine` a quarter
  // turn further. Angle 0 is at the arc's first corner. On a whole circle it is anywhere.
  BoundaryArc placed(const ExposedArc& exposed) const {
    const DualEdge& e = k_.edges[exposed.edge];
    const Sphere &a = ball(e.vertices[0]), &b = ball(e.vertices[1]);
    const EdgeShape shape = edge_shape(a, b);
    const Vec3d axis = (1 / shape.length) * (b.center - a.center);
    // Members: balls, ends, center, cosine, sine, sweep, radius. Those that are empty or 0 here are
    // set below.
    BoundaryArc arc{e.vertices,
                    {kNoIndex, kNoIndex},
                    a.center + shape.height[0] * axis,
                    {},
                    {},
                    0,
                    std::sqrt(shape.squared_circle_radius)};
    // On a circle as small as this, the positions of two corners may not give the angle between
    // them. kSmallCircle is a ratio of squared radii. It leaves more room than is_contact(), by
    // which leave_out() decides.
    const bool small =
        shape.squared_circle_radius < kSmallCircle * std::pow(std::min(a.radius, b.radius), 2);
    Vec3d out = any_orthogonal(axis);
    if (exposed.start == kNoCorner) {
      arc.sweep = 2 * std::numbers::pi;
      // In lattices, circles touch each other in the directions of the coordinate axes. The first
      // vertex of a whole circle is turned away from there by 1 rad, so that two circles have no
      // vertex in the point where they touch.
      out = std::cos(1.0) * out + std::sin(1.0) * cross(axis, out);
    } else {
      arc.ends = {corner_of_[exposed.start], corner_of_[exposed.end]};
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
  // the dihedral angles decide between the two. The sign of the small angle may be due to rounding.
  // So the result may exceed 2 pi by a rounding error.
  double sweep(const ExposedArc& arc, const Vec3d& axis, const Vec3d& p, const Vec3d& q,
               bool small) const {
    if (small) return angle_by_dihedrals(t_, k_, arc);
    const double angle = std::atan2(triple_product(axis, p, q), dot(p, q));
    if (std::abs(angle) >= kSmallArc) return angle < 0 ? angle + 2 * std::numbers::pi : angle;
    return angle_by_dihedrals(t_, k_, arc) > std::numbers::pi ? 2 * std::numbers::pi + angle
                                                              : std::abs(angle);
  }

  // Whether an arc is to be left out because it is too small; if so, counts it. Both feature sizes
  // refer to the lesser radius of its two balls. A whole circle that is a contact vanishes. An arc
  // becomes a point if it is short, or if its circle is a contact, however far the arc turns. The
  // ends of such an arc are kept, for join_corners().
  bool leave_out(const BoundaryArc& arc) {
    const double smaller_radius = std::min(ball(arc.balls[0]).radius, ball(arc.balls[1]).radius);
    const bool no_circle = out_.is_contact(arc.radius, smaller_radius);
    if (arc.is_circle() && no_circle) {
      ++out_.contacts;
    } else if (!arc.is_circle() &&
               (no_circle || arc.sweep * arc.radius <= out_.sizes.arc * smaller_radius)) {
      ++out_.points;
      short_arc_ends_.push_back(arc.ends);
    } else {
      return false;
    }
    return true;
  }

  // Finds pairs of corners of one ball that coincide: there, boundary curves of one patch meet in a
  // point. The distance counts in fractions of the ball's radius, as on the unit sphere on which
  // the patch is meshed. A ball has few corners as a rule, so all its pairs are compared.
  void find_coincident_corners() {
    using Pair = std::array<std::uint32_t, 2>;
    std::vector<Pair> listed;  // entries (ball, corner on its sphere), after sorting ball by ball
    listed.reserve(3 * out_.corners.size());
    for (std::uint32_t c = 0; c < out_.corners.size(); ++c) {
      for (const std::uint32_t b : out_.corners[c].balls) listed.push_back({b, c});
    }
    tbb::parallel_sort(listed.begin(), listed.end());
    const auto coincident = collect<Pair>(listed.size(), [&](std::size_t i, auto& found) {
      const double reach = out_.sizes.arc * ball(listed[i][0]).radius;
      for (std::size_t j = i + 1; j < listed.size() && listed[j][0] == listed[i][0]; ++j) {
        const Vec3d gap = out_.corners[listed[j][1]].position - out_.corners[listed[i][1]].position;
        if (squared_norm(gap) <= reach * reach) found.push_back({listed[i][1], listed[j][1]});
      }
    });
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
    const auto joined = join_touching_arcs(t_, out_);
    joined_.insert(joined_.end(), joined.begin(), joined.end());
    out_.has_joined_corners = corners < out_.corners.size() || !joined.empty();
  }

  // Replaces each set of joined corners by its member of lowest index, which is what
  // DisjointSets::find() returns. Removes the arcs that have become points. Numbers the corners
  // anew in the order of the arcs; corners in which no arc ends any more are dropped. Only pairs of
  // joined_ count in `joins`, since leave_out() has counted the short arcs in `points`.
  void join_corners() {
    out_.has_joined_corners =
        out_.has_joined_corners || !short_arc_ends_.empty() || !joined_.empty();
    DisjointSets sets(out_.corners.size());
    for (const auto& [a, b] : short_arc_ends_) sets.join(a, b);
    for (const auto& [a, b] : joined_) {
      out_.joins += sets.find(a) != sets.find(b);
      sets.join(a, b);
    }
    std::erase_if(out_.arcs, [&](const BoundaryArc& arc) { return is_point(arc, sets); });
    // By old index of a corner: its new index, or kNoIndex if no arc has asked for it yet.
    std::vector<std::uint32_t> number(out_.corners.size(), kNoIndex);
    std::vector<BoundaryCorner> kept;
    for (BoundaryArc& arc : out_.arcs) {
      if (arc.is_circle()) continue;
      for (std::uint32_t& end : arc.ends) {
        const std::uint32_t root = sets.find(end);
        if (number[root] == kNoIndex) {
          number[root] = static_cast<std::uint32_t>(kept.size());
          kept.push_back(out_.corners[root]);
        }
        end = number[root];
      }
    }
    out_.corners = std::move(kept);
  }

  // Closes slits. A slit is a patch without width: two other balls meet the ball in the same circle
  // from opposite sides, so that nothing of its sphere shows between them. The two arcs beside the
  // slit have the same ends and coincide in space. They become one arc between the two other balls.
  // Returns whether a slit was closed.
  bool close_slits() {
    // Entries (ball, end of lower index, end of higher index, arc). After sorting, arcs of one ball
    // with the same ends follow each other. So do all whole circles of a ball, whose ends are
    // kNoIndex.
    std::vector<std::array<std::uint32_t, 4>> places;
    places.reserve(2 * out_.arcs.size());
    for (std::uint32_t a = 0; a < out_.arcs.size(); ++a) {
      const BoundaryArc& arc = out_.arcs[a];
      const auto [low, high] = std::minmax(arc.ends[0], arc.ends[1]);
      for (const std::uint32_t b : arc.balls) places.push_back({b, low, high, a});
    }
    tbb::parallel_sort(places.begin(), places.end());
    // An arc takes part in one closure per call, because `places` has its former balls afterwards.
    // `gone` marks arcs to be removed.
    std::vector<char> changed(out_.arcs.size(), 0), gone(out_.arcs.size(), 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto [ball, low, high, a] = places[i];
      for (std::size_t j = i + 1; j < places.size(); ++j) {
        const std::uint32_t b = places[j][3];
        if (places[j][0] != ball || places[j][1] != low || places[j][2] != high) break;
        if (changed[a] || changed[b] || !is_slit(ball, out_.arcs[a], out_.arcs[b])) continue;
        // Arc a takes the ball on the far side of arc b in place of `ball`. Its frame can stay: its
        // axis runs from its first ball to its second, and as the three centres are in line with
        // `ball` in the middle (is_slit()), the axis towards the outer ball has the same direction.
        (out_.arcs[a].balls[0] == ball ? out_.arcs[a].balls[0] : out_.arcs[a].balls[1]) =
            other_ball(out_.arcs[b], ball);
        changed[a] = changed[b] = gone[b] = 1;
      }
    }
    std::size_t kept = 0;
    for (std::size_t a = 0; a < gone.size(); ++a) {
      if (gone[a]) continue;
      if (kept < a) out_.arcs[kept] = out_.arcs[a];
      ++kept;
    }
    const bool any = kept < gone.size();
    out_.joins += gone.size() - kept;
    out_.arcs.resize(kept);
    out_.has_joined_corners = out_.has_joined_corners || any;
    return any;
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

  const PowerTriangulation& t_;
  const DualComplex& k_;
  BoundaryArcs out_;
  // By CornerIndex of the dual complex: the index in out_.corners, or kNoIndex while the corner has
  // no position.
  std::vector<std::uint32_t> corner_of_;
  // Pairs of corners that are one point, as indices into out_.corners. short_arc_ends_ has the ends
  // of arcs that were left out, joined_ the pairs found by touching or by position.
  std::vector<std::array<std::uint32_t, 2>> short_arc_ends_, joined_;
};

}  // namespace

Vec3d BoundaryArc::at(double angle) const {
  return center + (std::cos(angle) * cosine + std::sin(angle) * sine);
}

BoundaryArcs boundary_arcs(const PowerTriangulation& triangulation, const DualComplex& complex,
                           const FeatureSizes& sizes) {
  return BoundaryBuilder(triangulation, complex, sizes).run();
}

}  // namespace vdwmesh
