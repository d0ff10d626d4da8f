// concave_patch(): the polygon of a probe's sides, the caps of its neighbours, and the boundary of
// what these leave of the polygon.
//
// 1. Each circle is cut by the other caps; what no cap covers and lies in the polygon is a segment
//    of the boundary, as are the sides, without the part between the cusps of a spindle.
// 2. Segments are chained to loops by the names of the circles that meet in their ends.
// 3. Gauss–Bonnet gives the area on the left of each loop as if it bounded a disk:
//    2 π + Σ φ h - Σ ε. Above 2 π it is the rim of a hole, because the polygon lies in a
//    hemisphere.
//
// All decisions of step 1 are made in double, and once more in wide numbers if one of them was
// close (kDoubtful). In wide numbers the probes have slightly different radii (kTieBreak), which
// decides ties the same way for all patches that meet in a point.
#include "excluded/concave_patch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "arrangement/complex/wide_points.hpp"
#include "arrangement/directions.hpp"
#include "excluded/cap_arrangement.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;

// A decision in double is doubtful if the number behind it, of order 1, is smaller than this. The
// rounding of a cap's axis is some 1e-15 over the distance of the probes in their radii; caps of
// probes nearer than kNearProbe are doubtful at once.
constexpr double kDoubtful = 1e-10, kNearProbe = 1e-4;
// Squared radii of probes differ by up to this fraction in wide numbers. Decisions closer than
// kTied are ties for the doubles given.
constexpr double kTieBreak = 1e-13, kTied = 1e-12;

// The exterior angle of the polygon at an atom.
double exterior_angle(const AccessibleSurface& surface, const Probe& probe, std::uint32_t atom) {
  double angle = 0;
  for (const CornerIndex c : surface.corners_of(probe)) {
    const auto& v = surface.triangle_of(c).vertices;
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] == atom) angle += surface.shapes().turning_angle(c / 2, k);
    }
  }
  return kPi - angle;
}

PatchSide patch_side(const AccessibleSurface& surface, const Probe& probe, const ProbeSide& at) {
  const RolledArc& arc = surface.arcs[at.arc];
  const double p = surface.probe_radius, rho = arc.circle_radius;
  const Profile profile = profile_of(arc, p);
  const Vec3d inwards = -rho * arc.radial[static_cast<std::size_t>(at.end)];
  const Vec3d tangent = cross(arc.axis, arc.radial[static_cast<std::size_t>(at.end)]);
  const double cusp = profile.spindle ? std::sqrt((p - rho) * (p + rho)) : 0;
  PatchSide side{};
  side.arc = at.arc;
  side.end = at.end;
  side.spindle = profile.spindle;
  side.gap = kNoIndex;
  side.inward = at.end == ArcEnd::end ? tangent : -1.0 * tangent;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t place = at.end == ArcEnd::end ? k : 1 - k;  // of ball k: from 0 to 1
    const double sign = k == 0 ? -1 : 1;
    side.atom[place] = arc.ball[k];
    side.contact[place] = unit(inwards + (sign * arc.height[k]) * arc.axis);
    side.cusp[place] = (1 / p) * (inwards + (sign * cusp) * arc.axis);
    side.angle[place] = sign * profile.end[k] - profile.cusp;
  }
  side.turning = exterior_angle(surface, probe, side.atom[1]);
  return side;
}

bool is_on_circle(const AccessibleSurface& surface, std::uint32_t probe, std::uint32_t edge) {
  const auto sides = surface.sides_of(surface.probes[probe]);
  return std::any_of(sides.begin(), sides.end(),
                     [&](const ProbeSide& s) { return surface.arcs[s.arc].edge == edge; });
}

// The next arc of a circle beyond the end of one, across the gap, that is neither dropped nor of a
// component that is left out.
std::uint32_t arc_beyond(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
                         std::uint32_t arc, ArcEnd end) {
  const auto side = static_cast<std::size_t>(end);
  std::uint32_t next = surface.arcs[arc].beyond[side];
  const auto counts = [&](const RolledArc& a) {
    return !a.dropped && included[surface.contacts[a.contact[0]].component] != 0;
  };
  while (next != arc && !counts(surface.arcs[next])) next = surface.arcs[next].beyond[side];
  return next;
}

class PatchMaker {
 public:
  PatchMaker(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
             std::uint32_t probe)
      : surface_(surface), included_(included), p_(surface.probe_radius) {
    patch_.probe = probe;
    patch_.sides = patch_sides(surface, surface.probes[probe]);
  }

  ConcavePatch make(const LowProbes& low) && {
    for (PatchSide& side : patch_.sides) {
      if (side.spindle) add_gap_cap(side);
    }
    gap_caps_ = patch_.caps.size();
    low.near(patch_.probe, [&](std::uint32_t other) { add_cap(other); });
    if (!cut<double>(kDoubtful)) {
      patch_.extended = true;
      patch_.tie = !cut<WideFloat>(kTied);
    }
    chain();
    return std::move(patch_);
  }

 private:
  const Probe& probe() const { return surface_.probes[patch_.probe]; }
  std::uint32_t cap_count() const { return static_cast<std::uint32_t>(patch_.caps.size()); }

  // Adds the cap of the probe beyond the gap of a spindle's circle. The plane that bisects both
  // contains the axis and halves the angle δ of the gap, which keeps its digits if δ is small.
  void add_gap_cap(PatchSide& side) {
    const RolledArc& arc = surface_.arcs[side.arc];
    const auto end = static_cast<std::size_t>(side.end);
    const std::uint32_t next = arc_beyond(surface_, included_, side.arc, side.end);
    const std::uint32_t other = surface_.arcs[next].probe[1 - end];
    const double half = gap_angle(arc, end, surface_.arcs[next], next == side.arc) / 2;
    for (std::uint32_t c = 0; c < cap_count(); ++c) {
      if (patch_.caps[c].probe == other) side.gap = c;
    }
    if (side.gap != kNoIndex) return;
    side.gap = cap_count();
    const Vec3d axis = std::cos(half) * side.inward - std::sin(half) * arc.radial[end];
    patch_.caps.push_back({unit(axis), arc.circle_radius * std::sin(half) / p_, other});
    if (other == patch_.probe) patch_.certified = false;
  }

  // The angle from the end of an arc over the gap to the next arc.
  static double gap_angle(const RolledArc& arc, std::size_t end, const RolledArc& next, bool same) {
    if (same) return 2 * kPi - arc.angle;
    const Vec3d &from = arc.radial[end], &to = next.radial[1 - end];
    const double sine = triple_product(arc.axis, from, to);
    const double angle = std::atan2(end == 1 ? sine : -sine, dot(from, to));
    constexpr double kClose = 1e-6;
    if (std::abs(angle) < kClose) return std::abs(angle);
    return angle < 0 ? angle + 2 * kPi : angle;
  }

  void add_cap(std::uint32_t other) {
    for (const PatchCap& cap : patch_.caps) {
      if (cap.probe == other) return;
    }
    for (const PatchSide& side : patch_.sides) {
      if (side.spindle && is_on_circle(surface_, other, surface_.arcs[side.arc].edge)) return;
    }
    const Vec3d apart = surface_.probes[other].center - probe().center;
    const double distance = norm(apart);
    if (!(distance > 0)) {
      patch_.tie = true;
      return;
    }
    const PatchCap cap{(1 / distance) * apart, distance / (2 * p_), other};
    if (cap.cosine < 1 && may_meet_polygon(cap)) patch_.caps.push_back(cap);
  }

  // Whether no side has the whole cap on its outer side.
  bool may_meet_polygon(const PatchCap& cap) const {
    constexpr double kSlack = 1e-6;
    const double sine = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    return std::none_of(patch_.sides.begin(), patch_.sides.end(), [&](const PatchSide& s) {
      return dot(cap.axis, s.inward) < -sine - kSlack;
    });
  }

  template <class T>
  Vector<T> center_in(std::uint32_t probe) const {
    const CornerIndex corner = surface_.probes[probe].corner;
    const auto& v = surface_.triangle_of(corner).vertices;
    const auto& balls = surface_.triangulation().balls;
    const auto point = common_points_wide(balls[v[0]], balls[v[1]], balls[v[2]])[corner % 2];
    const Vec3d& c = balls[v[0]].center;
    return {point.x + T(c.x), point.y + T(c.y), point.z + T(c.z)};
  }

  // Steps of the golden section spread numbers evenly over [0, 1).
  static double tie_weight(std::uint32_t probe) {
    constexpr double kGolden = 0.6180339887498949;
    const double product = kGolden * probe;
    return kTieBreak * (product - std::floor(product));
  }

  // The circles of all caps. In wide numbers from the atoms themselves.
  template <class T>
  std::vector<CapCircle<T>> circles() const {
    std::vector<CapCircle<T>> out;
    for (const PatchCap& cap : patch_.caps) {
      out.push_back(cap_circle(vector_in<T>(cap.axis), T(cap.cosine)));
    }
    if constexpr (!std::is_same_v<T, double>) {
      const Vector<T> x = center_in<T>(patch_.probe);
      for (std::size_t c = 0; c < out.size(); ++c) {
        const std::uint32_t other = patch_.caps[c].probe;
        const Vector<T> y = center_in<T>(other);
        const Vector<T> apart{y.x - x.x, y.y - x.y, y.z - x.z};
        const T distance = sqrt(dot(apart, apart));
        // Probes as near as this differ by rounding, if they do at all.
        if (distance < T(1e-9 * p_)) continue;
        const T weight = T(p_) * T(p_) * (T(tie_weight(patch_.probe)) - T(tie_weight(other)));
        const Vector<T> axis{apart.x / distance, apart.y / distance, apart.z / distance};
        out[c] = cap_circle(axis, T((distance + weight / distance) / (T(2) * T(p_))));
      }
    }
    return out;
  }

  // Finds all segments. Returns whether no decision was closer than `least`.
  template <class T>
  bool cut(double least) {
    double margin = 1;
    patch_.segments.clear();
    const std::vector<CapCircle<T>> all = circles<T>();
    for (std::uint32_t c = 0; c < all.size(); ++c) {
      if (std::is_same_v<T, double> && c >= gap_caps_ && patch_.caps[c].cosine < kNearProbe) {
        margin = 0;
      }
      cut_circle(all, c, margin);
    }
    add_sides();
    return margin >= least;
  }

  template <class T>
  void cut_circle(const std::vector<CapCircle<T>>& all, std::uint32_t c, double& margin) {
    std::vector<Covered<T>> covered;
    for (std::uint32_t j = 0; j < all.size(); ++j) {
      if (j == c) continue;
      Covered<T> part;
      const Overlap overlap = covered_part(all[c], all[j], j, part, margin);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) covered.push_back(part);
    }
    for (std::uint32_t s = 0; s < patch_.sides.size(); ++s) {
      const PatchSide& side = patch_.sides[s];
      if (side.gap != c) continue;
      covered.push_back({place_on(all[c], vector_in<T>(side.cusp[0])),
                         place_on(all[c], vector_in<T>(side.cusp[1])), cap_count() + s});
    }
    if (covered.empty()) {
      const Vec3d point = point_on(c, to_vec(all[c].first), 0);
      if (is_in_polygon(c, point, margin)) {
        patch_.segments.push_back({kNoIndex, c, kNoIndex, 0, 2 * kPi, point, point, 0});
      }
      return;
    }
    for (const Uncovered<T>& part : uncovered_parts(covered, margin)) add_arc(c, part, margin);
  }

  // Segments run clockwise about the cap's axis, against the uncovered part.
  template <class T>
  void add_arc(std::uint32_t c, const Uncovered<T>& part, double& margin) {
    if (!is_in_polygon(c, point_on(c, part.behind.to.point, part.angle / 2), margin)) return;
    const Vec3d &from = part.ahead.from.point, &to = part.behind.to.point;
    const std::uint32_t next = part.behind.by;
    patch_.segments.push_back(
        {part.ahead.by, c, next, 0, part.angle, from, to, turning_between(c, next, to)});
  }

  // The point of circle c at an angle counter-clockwise from the direction of `start`.
  Vec3d point_on(std::uint32_t c, const Vec3d& start, double angle) const {
    const auto& [axis, cosine, probe] = patch_.caps[c];
    const Vec3d e = unit(start - dot(start, axis) * axis);
    const double sine = std::sqrt((1 - cosine) * (1 + cosine));
    return cosine * axis + (sine * std::cos(angle)) * e + (sine * std::sin(angle)) * cross(axis, e);
  }

  // Whether a point of circle c is in the polygon. Sides whose cusps end the circle have been
  // taken into account.
  bool is_in_polygon(std::uint32_t c, const Vec3d& point, double& margin) const {
    double least = 1;
    for (const PatchSide& s : patch_.sides) {
      if (s.gap != c) least = std::min(least, dot(s.inward, point));
    }
    margin = std::min(margin, std::abs(least));
    return least > 0;
  }

  Vec3d axis_of(std::uint32_t circle) const {
    const std::uint32_t caps = cap_count();
    return circle < caps ? patch_.caps[circle].axis : -1.0 * patch_.sides[circle - caps].inward;
  }
  double cosine_of(std::uint32_t circle) const {
    return circle < cap_count() ? patch_.caps[circle].cosine : 0;
  }

  // The exterior angle where the boundary goes over from circle i to circle j.
  double turning_between(std::uint32_t i, std::uint32_t j, const Vec3d& point) const {
    const Vec3d a = axis_of(i), b = axis_of(j);
    const double sine = std::max(0.0, triple_product(point, a, b));
    return std::atan2(sine, dot(a, b) - cosine_of(i) * cosine_of(j));
  }

  // The number of the side that begins or ends where side s ends or begins.
  std::uint32_t side_at(std::uint32_t s, std::size_t end) const {
    for (std::uint32_t i = 0; i < patch_.sides.size(); ++i) {
      if (patch_.sides[i].atom[1 - end] == patch_.sides[s].atom[end]) return cap_count() + i;
    }
    return kNoIndex;
  }

  void add_sides() {
    for (std::uint32_t s = 0; s < patch_.sides.size(); ++s) {
      const PatchSide& side = patch_.sides[s];
      const std::uint32_t self = cap_count() + s, before = side_at(s, 0), next = side_at(s, 1);
      const auto& [from, to] = side.contact;
      if (!side.spindle) {
        const double angle = side.angle[0] + side.angle[1];
        patch_.segments.push_back({before, self, next, 0, angle, from, to, side.turning});
        continue;
      }
      patch_.segments.push_back({before, self, side.gap, 0, side.angle[0], from, side.cusp[0],
                                 turning_between(self, side.gap, side.cusp[0])});
      patch_.segments.push_back(
          {side.gap, self, next, 0, side.angle[1], side.cusp[1], to, side.turning});
    }
  }

  // The segment behind another one on its loop.
  std::optional<std::uint32_t> successor(const PatchSegment& s) const {
    for (std::uint32_t i = 0; i < patch_.segments.size(); ++i) {
      const PatchSegment& other = patch_.segments[i];
      if (other.circle == s.next && other.before == s.circle) return i;
    }
    return std::nullopt;
  }

  struct Loop {
    double solid_angle;
    Vec3d vector;
    std::vector<std::uint32_t> segments;
  };

  Vec3d vector_of(const PatchSegment& s) const {
    const Vec3d axis = axis_of(s.circle);
    const double h = cosine_of(s.circle), squared_sine = (1 - h) * (1 + h);
    return -0.5 * ((squared_sine * s.angle) * axis - h * cross(axis, s.to - s.from));
  }

  // Joins the segments to loops. A loop that does not close is left out, and not certified.
  std::vector<Loop> loops() {
    std::vector<Loop> out;
    std::vector<std::uint8_t> used(patch_.segments.size(), 0);
    for (std::uint32_t first = 0; first < used.size(); ++first) {
      if (used[first]) continue;
      Loop loop{2 * kPi, {0, 0, 0}, {}};
      std::optional<std::uint32_t> i = first;
      while (i && !used[*i]) {
        used[*i] = 1;
        const PatchSegment& s = patch_.segments[*i];
        loop.solid_angle += s.angle * cosine_of(s.circle) - s.turning;
        loop.vector = loop.vector + vector_of(s);
        loop.segments.push_back(*i);
        i = s.next == kNoIndex && s.before == kNoIndex ? first : successor(s);
      }
      if (i != first) patch_.certified = false;
      out.push_back(std::move(loop));
    }
    return out;
  }

  void add_to_piece(std::uint32_t piece, const Loop& loop, double solid_angle) {
    PatchPiece& p = patch_.pieces[piece];
    p.solid_angle += solid_angle;
    p.vector = p.vector + loop.vector;
    ++p.loops;
    for (const std::uint32_t s : loop.segments) patch_.segments[s].piece = piece;
  }

  void chain() {
    const std::vector<Loop> all = loops();
    std::vector<const Loop*> outer;
    // Without a side the patch is the whole sphere less its caps.
    if (patch_.sides.empty()) {
      patch_.pieces.push_back({4 * kPi, {0, 0, 0}, 0});
      outer.push_back(nullptr);
    }
    for (const Loop& loop : all) {
      if (loop.solid_angle > 2 * kPi) continue;
      patch_.pieces.push_back({0, {0, 0, 0}, 0});
      add_to_piece(static_cast<std::uint32_t>(outer.size()), loop, loop.solid_angle);
      outer.push_back(&loop);
    }
    for (const Loop& loop : all) {
      if (loop.solid_angle > 2 * kPi) {
        add_to_piece(piece_around(loop, outer), loop, loop.solid_angle - 4 * kPi);
      }
    }
  }

  // The piece in which a hole is: of those whose outer loop is around it the smallest.
  std::uint32_t piece_around(const Loop& hole, const std::vector<const Loop*>& outer) {
    if (outer.size() == 1) return 0;
    const Vec3d& point = patch_.segments[hole.segments[0]].from;
    std::uint32_t best = kNoIndex;
    for (std::uint32_t i = 0; i < outer.size(); ++i) {
      if (outer[i] != nullptr && !is_inside(point, *outer[i])) continue;
      if (best == kNoIndex || patch_.pieces[i].solid_angle < patch_.pieces[best].solid_angle) {
        best = i;
      }
    }
    if (best == kNoIndex) patch_.certified = false;
    return best == kNoIndex ? 0 : best;
  }

  // Whether a loop is around a point: whether it crosses the half great circle from the point past
  // the middle of the other hemisphere an odd number of times.
  bool is_inside(const Vec3d& point, const Loop& loop) const {
    Vec3d away{0, 0, 0};
    for (const PatchSide& s : patch_.sides) away = away - s.contact[0];
    const Vec3d toward = unit(away - dot(away, point) * point);
    bool inside = false;
    for (const std::uint32_t i : loop.segments) {
      inside ^= (crossings(patch_.segments[i], point, toward) & 1) != 0;
    }
    return inside;
  }

  // How often a segment crosses the half great circle cos(τ) point + sin(τ) toward, 0 < τ < π.
  int crossings(const PatchSegment& s, const Vec3d& point, const Vec3d& toward) const {
    const Vec3d axis = axis_of(s.circle);
    const double x = dot(axis, point), y = dot(axis, toward), size = std::hypot(x, y);
    const double ratio = cosine_of(s.circle) / size;
    if (!(std::abs(ratio) < 1)) return 0;
    int count = 0;
    for (const double sign : {-1.0, 1.0}) {
      const double tau = std::remainder(std::atan2(y, x) + sign * std::acos(ratio), 2 * kPi);
      if (tau <= 0) continue;
      const Vec3d w = std::cos(tau) * point + std::sin(tau) * toward;
      const Vec3d from = s.from - dot(s.from, axis) * axis, at = w - dot(w, axis) * axis;
      double angle = -std::atan2(triple_product(axis, from, at), dot(from, at));
      if (angle < 0) angle += 2 * kPi;
      count += angle < s.angle;
    }
    return count;
  }

  const AccessibleSurface& surface_;
  std::span<const std::uint8_t> included_;
  const double p_;
  ConcavePatch patch_;
  std::size_t gap_caps_ = 0;  // the first caps, by construction
};

}  // namespace

std::vector<PatchSide> patch_sides(const AccessibleSurface& surface, const Probe& probe) {
  std::vector<PatchSide> sides;
  for (const ProbeSide& at : surface.sides_of(probe)) {
    sides.push_back(patch_side(surface, probe, at));
  }
  return sides;
}

ConcavePatch whole_patch(const AccessibleSurface& surface, std::uint32_t probe) {
  const Probe& p = surface.probes[probe];
  ConcavePatch patch{probe, patch_sides(surface, p), {}, {}, {}};
  for (std::uint32_t s = 0; s < patch.sides.size(); ++s) {
    const PatchSide& side = patch.sides[s];
    patch.segments.push_back({kNoIndex, s, kNoIndex, 0, side.angle[0] + side.angle[1],
                              side.contact[0], side.contact[1], side.turning});
  }
  const std::uint32_t loops = patch.sides.empty() ? 0 : 1;
  patch.pieces.push_back({p.solid_angle, polygon_vector(patch.sides), loops});
  return patch;
}

double flat_faces(const ConcavePatch& patch, std::span<const HalfSpace> within) {
  std::vector<HalfSpace> walls(within.begin(), within.end());
  for (const PatchSide& s : patch.sides) walls.push_back({-1.0 * s.inward, 0});
  for (const PatchCap& c : patch.caps) walls.push_back({c.axis, c.cosine});
  double sum = 0;
  for (std::size_t c = 0; c < patch.caps.size(); ++c) {
    std::vector<HalfSpace> others = walls;
    others.erase(others.end() - static_cast<std::ptrdiff_t>(patch.caps.size() - c));
    sum += patch.caps[c].cosine * face_area(patch.caps[c].axis, patch.caps[c].cosine, others);
  }
  return sum;
}

Vec3d polygon_vector(const std::vector<PatchSide>& sides) {
  Vec3d sum{0, 0, 0};
  for (const PatchSide& s : sides) {
    sum = sum + (0.5 * (s.angle[0] + s.angle[1])) * s.inward;
  }
  return sum;
}

ConcavePatch concave_patch(const AccessibleSurface& surface, const LowProbes& low,
                           std::span<const std::uint8_t> included, std::uint32_t probe) {
  return PatchMaker(surface, included, probe).make(low);
}

}  // namespace vdwmesh::excluded
