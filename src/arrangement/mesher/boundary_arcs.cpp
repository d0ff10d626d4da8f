// Places the exposed arcs of the dual complex in space and reduces those that are too small.
//
// Steps: (1) each arc of exposed_arcs() gets the frame of its circle and its sweep angle; each
// corner is computed once, from its three spheres, and shared by its arcs. (2) Circles of one ball
// that touch get a common corner (touching_arcs.cpp). (3) Corners of one ball that coincide within
// FeatureSizes::arc are found. (4) All corners that are one point are merged by union-find, and
// arcs between them that have become points are removed. (5) Patches without width are closed until
// there is none left.
#include "arrangement/mesher/boundary_arcs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/complex/arc_angle.hpp"
#include "arrangement/complex/simplex_shape.hpp"
#include "arrangement/directions.hpp"
#include "arrangement/mesher/touching_arcs.hpp"
#include "core/disjoint_sets.hpp"

namespace vdwmesh {
namespace {

// Corners are joined pair by pair, so two corners of one set can be farther apart than the
// threshold of a pair. An arc between them still counts as a point up to this multiple of the
// threshold. The factor is an allowance for such chains and no proven bound: a longer arc stays, as
// a loop.
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
    for (const ExposedArc& arc : exposed_arcs(t_, k_)) place(arc);
    find_touching_arcs();
    find_coincident_corners();
    join_corners();
    // A closed slit can make another one. Each successful pass removes an arc, so the loop ends.
    while (close_slits()) {
    }
    return std::move(out_);
  }

 private:
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  // The number of a corner of the dual complex in the result; its position is computed at first
  // use.
  std::uint32_t corner(CornerIndex index) {
    std::uint32_t& place = corner_of_[index];
    if (place != kNoIndex) return place;
    // A CornerIndex is 2 × triangle + side; side 0 lies above the triangle.
    const DualTriangle& f = k_.triangles[index / 2];
    const Sphere& a = ball(f.vertices[0]);
    const CommonPoints points = common_points(a, ball(f.vertices[1]), ball(f.vertices[2]));
    place = static_cast<std::uint32_t>(out_.corners.size());
    out_.corners.push_back({a.center + (index % 2 == 0 ? points.above : points.below), f.vertices});
    return place;
  }

  // Computes the frame and the sweep of one arc. Its zero direction `out` points to its first
  // corner.
  void place(const ExposedArc& exposed) {
    const DualEdge& e = k_.edges[exposed.edge];
    const Sphere &a = ball(e.vertices[0]), &b = ball(e.vertices[1]);
    const EdgeShape shape = edge_shape(a, b);
    const Vec3d axis = (1 / shape.length) * (b.center - a.center);
    BoundaryArc arc{e.vertices,
                    {kNoIndex, kNoIndex},
                    a.center + shape.height[0] * axis,
                    {},
                    {},
                    0,
                    std::sqrt(shape.squared_circle_radius)};
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
      arc.ends = {corner(exposed.start), corner(exposed.end)};
      const Vec3d p = out_.corners[arc.ends[0]].position - arc.center,
                  q = out_.corners[arc.ends[1]].position - arc.center;
      const Vec3d radial = p - dot(p, axis) * axis;
      // The corner is projected into the circle's plane, which it leaves by rounding errors only.
      if (norm(radial) > 0) out = (1 / norm(radial)) * radial;
      arc.sweep = sweep(exposed, axis, p, q, small);
    }
    arc.cosine = arc.radius * out;
    arc.sine = arc.radius * cross(axis, out);
    add(arc, std::min(a.radius, b.radius));
  }

  // The angle from corner p to corner q about the axis, between 0 and a whole turn. Both corners
  // are given relative to the circle's centre.
  //
  // Their positions decide the angle, with two exceptions: on a tiny circle, and if they are so
  // close together that rounding could take a tiny angle for a whole turn. In these cases the
  // dihedral angles of the triangulation decide (arc_angle.hpp).
  double sweep(const ExposedArc& arc, const Vec3d& axis, const Vec3d& p, const Vec3d& q,
               bool small) const {
    if (small) return angle_by_dihedrals(t_, k_, arc);
    const double angle = std::atan2(triple_product(axis, p, q), dot(p, q));
    if (std::abs(angle) >= kSmallArc) return angle < 0 ? angle + 2 * std::numbers::pi : angle;
    return angle_by_dihedrals(t_, k_, arc) > std::numbers::pi ? 2 * std::numbers::pi + angle
                                                              : std::abs(angle);
  }

  // Keeps an arc, or reduces it if it is too small. An arc of a tiny circle counts as a point
  // however far it turns, because its circle is no larger than a contact.
  void add(const BoundaryArc& arc, double smaller_radius) {
    const bool no_circle = out_.is_contact(arc.radius, smaller_radius);
    if (arc.is_circle() && no_circle) {
      ++out_.contacts;
    } else if (!arc.is_circle() &&
               (no_circle || arc.sweep * arc.radius <= out_.sizes.arc * smaller_radius)) {
      ++out_.points;
      short_arc_ends_.push_back(arc.ends);
    } else {
      out_.arcs.push_back(arc);
    }
  }

  // Finds pairs of corners of one ball that coincide: there, boundary curves of one patch meet in a
  // point. A ball has few corners as a rule, so all its pairs are compared.
  void find_coincident_corners() {
    std::vector<std::array<std::uint32_t, 2>> places;  // ball, corner
    for (std::uint32_t c = 0; c < out_.corners.size(); ++c) {
      for (const std::uint32_t b : out_.corners[c].balls) places.push_back({b, c});
    }
    std::sort(places.begin(), places.end());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double reach = out_.sizes.arc * ball(places[i][0]).radius;
      for (std::size_t j = i + 1; j < places.size() && places[j][0] == places[i][0]; ++j) {
        const Vec3d gap = out_.corners[places[j][1]].position - out_.corners[places[i][1]].position;
        if (squared_norm(gap) <= reach * reach) joined_.push_back({places[i][1], places[j][1]});
      }
    }
  }

  // Whether both ends of an arc have become one corner and the arc is so short that it is that
  // point. An arc with one end that turns around most of its circle is a loop and stays.
  bool is_point(const BoundaryArc& arc, DisjointSets& sets) const {
    if (arc.is_circle() || sets.find(arc.ends[0]) != sets.find(arc.ends[1])) return false;
    const double reach =
        out_.sizes.arc * std::max(ball(arc.balls[0]).radius, ball(arc.balls[1]).radius);
    return arc.sweep * arc.radius <= kJoinAllowance * reach;
  }

  // Gives touching circles a common corner. This may cut arcs and append corners.
  void find_touching_arcs() {
    const std::size_t corners = out_.corners.size();
    const auto joined = join_touching_arcs(t_, out_);
    joined_.insert(joined_.end(), joined.begin(), joined.end());
    out_.has_joined_corners = corners < out_.corners.size() || !joined.empty();
  }

  // Replaces each set of joined corners by its member of lowest number. Corners in which no arc
  // ends any more are dropped.
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
  // slit have the same ends and the same place. They become one arc between the two other balls.
  // Returns whether there was a slit.
  bool close_slits() {
    // Entries (ball, lower end, higher end, arc). After sorting, arcs of one ball with the same
    // ends follow each other. So do all whole circles of a ball, whose ends are kNoIndex.
    std::vector<std::array<std::uint32_t, 4>> places;
    for (std::uint32_t a = 0; a < out_.arcs.size(); ++a) {
      const BoundaryArc& arc = out_.arcs[a];
      const auto [low, high] = std::minmax(arc.ends[0], arc.ends[1]);
      for (const std::uint32_t b : arc.balls) places.push_back({b, low, high, a});
    }
    std::sort(places.begin(), places.end());
    // An arc takes part in one closure per pass, because its balls change.
    std::vector<char> changed(out_.arcs.size(), 0), gone(out_.arcs.size(), 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto [ball, low, high, a] = places[i];
      for (std::size_t j = i + 1; j < places.size(); ++j) {
        const std::uint32_t b = places[j][3];
        if (places[j][0] != ball || places[j][1] != low || places[j][2] != high) break;
        if (changed[a] || changed[b] || !is_slit(ball, out_.arcs[a], out_.arcs[b])) continue;
        // Arc a takes the ball beyond arc b in place of the closed one. It keeps its direction:
        // is_slit() makes sure that the two outer balls lie on opposite sides of the ball between
        // them.
        (out_.arcs[a].balls[0] == ball ? out_.arcs[a].balls[0] : out_.arcs[a].balls[1]) =
            other_ball(out_.arcs[b], ball);
        changed[a] = changed[b] = gone[b] = 1;
      }
    }
    std::size_t kept = 0;
    for (std::size_t a = 0; a < gone.size(); ++a) {
      if (!gone[a]) out_.arcs[kept++] = out_.arcs[a];
    }
    const bool any = kept < gone.size();
    out_.joins += gone.size() - kept;
    out_.arcs.resize(kept);
    out_.has_joined_corners = out_.has_joined_corners || any;
    return any;
  }

  static std::uint32_t other_ball(const BoundaryArc& arc, std::uint32_t ball) {
    return arc.balls[arc.balls[0] == ball ? 1 : 0];
  }

  // Whether two arcs of the ball that have the same ends bound a slit. The two other balls must lie
  // on opposite sides of this ball, and the arcs must coincide within the length that counts as a
  // point. For arcs with ends it is enough to compare their midpoints, since the circles then agree
  // in three points. For whole circles, the sum below bounds the distance of any point of one
  // circle from the other: the shift of the centre, the difference of the radii, and the tilt of
  // the planes at the rim.
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
  // By CornerIndex of the dual complex: the corner of the result, or kNoIndex while it is not
  // placed.
  std::vector<std::uint32_t> corner_of_;
  // Pairs of corners that are one point: the ends of an arc of no length, and those found by
  // position.
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
