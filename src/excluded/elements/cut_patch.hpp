// The concave patch of a low probe in double: its polygon less the caps of its neighbours. For the
// library's own use, on the host and on a CUDA device. The rules are those of concave_patch.cpp,
// patch_boundary.cpp and patch_loops.cpp, in memory of fixed size.
//
// A patch is not measured if there is no room for it, if a decision is close, if its boundary does
// not close, or if the shares of its balls do not sum to its solid angle.
#pragma once

#include "excluded/elements/element_shapes.hpp"
#include "excluded/patches/cap_arrangement.hpp"
#include "excluded/probes/circle_gap.hpp"

namespace vdwmesh::excluded::elements {

// A decision in double is close if its margin is smaller than kCloseDecision. Probes are near if
// their distance is less than kNearbyProbe radii of a probe. The same values are in
// concave_patch.cpp.
inline constexpr double kCloseDecision = 1e-10, kNearbyProbe = 1e-4;
inline constexpr int kMostCaps = 28, kMostSegments = 80, kMostFacePoints = 48;
// The sum of the shares and the solid angle may differ by this: far more than rounding, far less
// than a missing part.
inline constexpr double kShareError = 1e-8;

// Low probes, and for each the others that overlap it.
struct LowList {
  const std::uint32_t* corner;  // by low probe
  const std::uint64_t* first;   // size + 1
  const std::uint32_t* other;   // low probes
  std::uint32_t size;
};

class CutPatch {
 public:
  VDWMESH_HD CutPatch(const Balls& balls, const Corner* corners, const Arc* arcs,
                      const ArcShape* shapes, std::uint32_t self, const Polygon& polygon)
      : balls_(balls),
        corners_(corners),
        arcs_(arcs),
        shapes_(shapes),
        self_(self),
        corner_(corners[self]),
        polygon_(polygon) {}

  // Returns whether the patch was measured.
  VDWMESH_HD bool measure(const LowList& low, std::uint32_t index, PatchMeasures& out) {
    for (Side& s : polygon_.side) {
      if (s.spindle) add_gap_cap(s);
      if (shapes_[s.arc].radius < kNearbyProbe * balls_.probe) return false;
    }
    for (std::uint64_t i = low.first[index]; i < low.first[index + 1] && good_; ++i) {
      add_cap(low.corner[low.other[i]]);
    }
    if (!good_) return false;
    for (int c = 0; c < caps_ && good_; ++c) cut_circle(c);
    add_sides();
    if (!good_ || !(margin_ >= kCloseDecision)) return false;
    join_loops(out);
    if (!good_) return false;
    count(out);
    return share(out);
  }

 private:
  struct CapAtCorner {
    CapCircle<double> circle;
    std::uint32_t corner;
  };
  struct Segment {
    int before, circle, next;  // caps, then sides; -1: a whole circle
    double angle;
    Vec3d from, to;
    double turning;
  };

  VDWMESH_HD static Vec3d vec(const Vector<double>& v) { return {v.x, v.y, v.z}; }
  VDWMESH_HD static Vector<double> vector(const Vec3d& v) { return {v.x, v.y, v.z}; }
  VDWMESH_HD Vec3d axis_of(int circle) const {
    return circle < caps_ ? vec(cap_[circle].circle.axis)
                          : -1.0 * polygon_.side[circle - caps_].inward;
  }
  VDWMESH_HD double cosine_of(int circle) const {
    return circle < caps_ ? cap_[circle].circle.cosine : 0;
  }

  VDWMESH_HD void put_cap(const Vec3d& axis, double cosine, std::uint32_t corner) {
    if (caps_ == kMostCaps || !(cosine >= kNearbyProbe)) {
      good_ = false;
      return;
    }
    cap_[caps_++] = {cap_circle(vector(axis), cosine), corner};
  }

  // Adds the cap of the probe beyond the gap of a spindle's circle.
  VDWMESH_HD void add_gap_cap(Side& side) {
    const Arc& arc = arcs_[side.arc];
    const std::uint32_t next = side.end == 1 ? arc.next(side.arc) : arc.previous(side.arc);
    const std::uint32_t other = arcs_[next].corner[1 - side.end];
    if (other == self_) good_ = false;
    for (int c = 0; c < caps_; ++c) {
      if (cap_[c].corner == other) side.gap = c;
    }
    if (side.gap >= 0) return;
    const ArcShape& shape = shapes_[side.arc];
    const Vec3d& from = shape.radial[side.end];
    const double angle =
        next == side.arc
            ? 2 * kPi - shape.angle
            : gap_angle(shape.axis, from, shapes_[next].radial[1 - side.end], side.end == 1);
    const GapCap cap = gap_cap(angle, from, side.inward, shape.radius, balls_.probe);
    side.gap = caps_;
    put_cap(cap.axis, cap.cosine, other);
  }

  VDWMESH_HD void add_cap(std::uint32_t other) {
    const Corner& o = corners_[other];
    for (int c = 0; c < caps_; ++c) {
      if (cap_[c].corner == other) return;
    }
    for (const Side& s : polygon_.side) {
      const Arc& arc = arcs_[s.arc];
      if (s.spindle && touches(o.name, arc.ball[0]) && touches(o.name, arc.ball[1])) return;
    }
    const Vec3d apart =
        (balls_.grown[o.name.ball[0]].center - balls_.grown[corner_.name.ball[0]].center) +
        (o.at - corner_.at);
    const double distance = norm(apart), cosine = distance / (2 * balls_.probe);
    if (!(cosine < 1)) return;
    if (!(distance > kNearbyProbe * balls_.probe)) {
      good_ = false;
      return;
    }
    const Vec3d axis = (1 / distance) * apart;
    constexpr double kSlack = 1e-6;
    const double sine = circle_radius(cosine);
    for (const Side& s : polygon_.side) {
      if (dot(axis, s.inward) < -sine - kSlack) return;
    }
    put_cap(axis, cosine, other);
  }

  VDWMESH_HD void put_segment(const Segment& segment) {
    if (segments_ == kMostSegments) {
      good_ = false;
      return;
    }
    segment_[segments_++] = segment;
  }

  VDWMESH_HD void put_covered(const Covered<double>& part) {
    int place = covers_++;
    for (; place > 0 && covered_[place - 1].from.turn > part.from.turn; --place) {
      covered_[place] = covered_[place - 1];
    }
    covered_[place] = part;
  }

  VDWMESH_HD void cut_circle(int c) {
    const CapCircle<double>& circle = cap_[c].circle;
    covers_ = 0;
    for (int j = 0; j < caps_; ++j) {
      if (j == c) continue;
      Covered<double> part;
      const Overlap overlap =
          covered_part(circle, cap_[j].circle, static_cast<std::uint32_t>(j), part, margin_);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) put_covered(part);
    }
    const double radius = circle_radius(circle.cosine);
    for (int s = 0; s < 3; ++s) {
      const Side& side = polygon_.side[s];
      if (side.gap != c) continue;
      put_covered({place_on(circle, vector(side.cusp[0]), 1 / radius),
                   place_on(circle, vector(side.cusp[1]), 1 / radius),
                   static_cast<std::uint32_t>(caps_ + s)});
    }
    if (covers_ == 0) {
      const Vector<double> point = combination(circle.cosine, circle.axis, radius, circle.first);
      if (is_inside(polygon_depth(c, vec(point)))) {
        put_segment({-1, c, -1, 2 * kPi, vec(point), vec(point), 0});
      }
      return;
    }
    narrow_by_order();
    add_uncovered(c);
  }

  // The margin of the order of all places about the circle.
  VDWMESH_HD void narrow_by_order() {
    places_ = 0;
    for (int i = 0; i < covers_; ++i) {
      put_place(covered_[i].from);
      put_place(covered_[i].to);
    }
    for (int i = 0; i < places_; ++i) {
      const bool last = i + 1 == places_;
      const int j = last ? 0 : i + 1;
      const double ahead = last ? turn_[j] + 4 : turn_[j];
      narrow((ahead - turn_[i]) / (slide_[i] + slide_[j]));
    }
  }
  VDWMESH_HD void put_place(const CirclePlace<double>& place) {
    int i = places_++;
    for (; i > 0 && turn_[i - 1] > place.turn; --i) {
      turn_[i] = turn_[i - 1];
      slide_[i] = slide_[i - 1];
    }
    turn_[i] = place.turn;
    slide_[i] = place.slide;
  }
  VDWMESH_HD void narrow(double margin) {
    if (!(margin >= margin_)) margin_ = margin;
  }

  // The parts of circle c between its covered ones, as uncovered_parts() finds them.
  VDWMESH_HD void add_uncovered(int c) {
    int farthest = -1;
    double reach = 0;
    for (int step = 0; step < 2 * covers_; ++step) {
      const bool second = step >= covers_;
      const int i = second ? step - covers_ : step;
      const Covered<double>& part = covered_[i];
      const double start = second ? part.from.turn + 4 : part.from.turn;
      if (second && start > reach) {
        add_arc(c, covered_[farthest], part,
                angle_between(covered_[farthest].to, part.from, start - reach));
      }
      double stop = second ? part.to.turn + 4 : part.to.turn;
      if (stop < start) stop += 4;
      if (farthest < 0 || stop > reach) {
        reach = stop;
        farthest = i;
      }
    }
  }

  // A segment runs clockwise about the cap's axis, an uncovered part counter-clockwise.
  VDWMESH_HD void add_arc(int c, const Covered<double>& behind, const Covered<double>& ahead,
                          double angle) {
    const Vector<double>&from = ahead.from.point, &to = behind.to.point;
    double depth = 0;
    for (int i = 0; i < 3; ++i) {
      const double fraction = i == 0 ? 0.5 : (i == 1 ? 0.3 : 0.8);
      const double here = polygon_depth(c, vec(point_beyond(cap_[c].circle, to, fraction * angle)));
      if (std::abs(here) > std::abs(depth)) depth = here;
      constexpr double kDeep = 1e-6;
      if (std::abs(depth) > kDeep) break;
    }
    if (!is_inside(depth)) return;
    const int next = static_cast<int>(behind.by);
    put_segment({static_cast<int>(ahead.by), c, next, angle, vec(from), vec(to),
                 turning_between(c, next, vec(to))});
  }

  VDWMESH_HD double polygon_depth(int c, const Vec3d& point) const {
    double least = 1;
    for (const Side& s : polygon_.side) {
      const double depth = dot(s.inward, point);
      if (s.gap != c && depth < least) least = depth;
    }
    return least;
  }
  VDWMESH_HD bool is_inside(double depth) {
    narrow(std::abs(depth));
    return depth > 0;
  }

  // The exterior angle where the boundary goes over from circle i to circle j.
  VDWMESH_HD double turning_between(int i, int j, const Vec3d& point) const {
    const Vec3d a = axis_of(i), b = axis_of(j);
    const double sine = dot(point, cross(a, b));
    return std::atan2(sine > 0 ? sine : 0, dot(a, b) - cosine_of(i) * cosine_of(j));
  }

  // The number of the side that begins or ends where a side ends or begins.
  VDWMESH_HD int side_at(const Side& side, int end) const {
    for (int i = 0; i < 3; ++i) {
      if (polygon_.side[i].slot[1 - end] == side.slot[end]) return caps_ + i;
    }
    good_ = false;
    return caps_;
  }

  VDWMESH_HD void add_sides() {
    for (int s = 0; s < 3; ++s) {
      const Side& side = polygon_.side[s];
      const int self = caps_ + s, before = side_at(side, 0), next = side_at(side, 1);
      if (!side.spindle) {
        put_segment({before, self, next, side.angle[0] + side.angle[1], side.contact[0],
                     side.contact[1], side.turning});
        continue;
      }
      put_segment({before, self, side.gap, side.angle[0], side.contact[0], side.cusp[0],
                   turning_between(self, side.gap, side.cusp[0])});
      put_segment(
          {side.gap, self, next, side.angle[1], side.cusp[1], side.contact[1], side.turning});
    }
  }

  // The segment behind another one on its loop, or -1.
  VDWMESH_HD int successor(const Segment& s) const {
    for (int i = 0; i < segments_; ++i) {
      if (segment_[i].circle == s.next && segment_[i].before == s.circle) return i;
    }
    return -1;
  }

  VDWMESH_HD Vec3d vector_of(const Segment& s) const {
    const Vec3d axis = axis_of(s.circle);
    const double h = cosine_of(s.circle), squared_sine = (1 - h) * (1 + h);
    return -0.5 * ((squared_sine * s.angle) * axis - h * cross(axis, s.to - s.from));
  }

  // Chains the segments to loops. A loop without a side is the rim of a hole if what is on its left
  // is a hemisphere or more. The Euler characteristic of the faces is 2 for each piece, less 1 for
  // each loop.
  VDWMESH_HD void join_loops(PatchMeasures& out) {
    constexpr double kRounding = 1e-6;
    std::uint32_t used[(kMostSegments + 31) / 32] = {};
    int loops = 0, pieces = 0;
    for (int first = 0; first < segments_; ++first) {
      if (used[first / 32] >> (first % 32) & 1) continue;
      double solid_angle = 2 * kPi;
      bool hole = true;
      int i = first;
      while (i >= 0 && !(used[i / 32] >> (i % 32) & 1)) {
        used[i / 32] |= 1u << (i % 32);
        const Segment& s = segment_[i];
        solid_angle += s.angle * cosine_of(s.circle) - s.turning;
        out.vector = out.vector + vector_of(s);
        hole = hole && s.circle < caps_;
        i = s.next < 0 ? first : successor(s);
      }
      if (i != first) good_ = false;
      hole = hole && solid_angle > 2 * kPi - kRounding;
      out.solid_angle += hole ? solid_angle - 4 * kPi : solid_angle;
      ++loops;
      pieces += !hole;
    }
    if (pieces == 0) good_ = false;
    out.sixths = 6 * (2 * pieces - loops);
  }

  VDWMESH_HD std::uint64_t end_number(int i, int j) const {
    if (i >= caps_) return cusp_number(polygon_.side[i - caps_], 0);
    if (j >= caps_) return cusp_number(polygon_.side[j - caps_], 1);
    return number_of_point(number_of(corner_.name), number_of(corners_[cap_[i].corner].name),
                           number_of(corners_[cap_[j].corner].name), true);
  }
  VDWMESH_HD std::uint64_t cusp_number(const Side& side, int which) const {
    const Arc& arc = arcs_[side.arc];
    return number_of_cusp(arc.ball[0], arc.ball[1], corner_.name.ball[side.slot[which]]);
  }

  // Edges and vertices of the patch, and the names of its creases.
  VDWMESH_HD void count(PatchMeasures& out) const {
    for (const Side& s : polygon_.side) out.sixths -= s.spindle ? 6 : 0;
    const std::uint64_t own = number_of(corner_.name);
    for (int i = 0; i < segments_; ++i) {
      const Segment& s = segment_[i];
      if (s.circle >= caps_) continue;
      ++out.crease_arcs;
      const std::uint64_t other = number_of(corners_[cap_[s.circle].corner].name);
      const bool whole = s.next < 0;
      out.creases += number_of_crease(own, other, whole ? 0 : end_number(s.before, s.circle),
                                      whole ? 0 : end_number(s.circle, s.next));
      if (whole) continue;
      out.sixths -= 3;
      if (s.next < caps_) out.sixths += 2;
    }
  }

  // Divides the patch between its three balls.
  VDWMESH_HD bool share(PatchMeasures& out) {
    for (int i = 0; i < segments_; ++i) {
      const Segment& s = segment_[i];
      const bool side = s.circle >= caps_;
      const SphereArc arc =
          side ? SphereArc{polygon_.side[s.circle - caps_].inward, 0, s.from, s.angle}
               : SphereArc{axis_of(s.circle), cosine_of(s.circle), s.from, -s.angle};
      share_arc(balls_, corner_, polygon_, arc, out.share);
    }
    for (int i = 0; i < 3; ++i) out.flat[i] = flat_faces(i);
    const double sum = out.share[0] + out.share[1] + out.share[2];
    return std::abs(sum - out.solid_angle) < kShareError;
  }

  // Sum over the caps of cosine × area of the flat face's part that belongs to a ball.
  VDWMESH_HD double flat_faces(int ball) const {
    double sum = 0;
    for (int c = 0; c < caps_; ++c) sum += cosine_of(c) * face_area(c, ball);
    return sum;
  }

  VDWMESH_HD double face_area(int c, int ball) const {
    const Vec3d axis = axis_of(c), first = any_orthogonal(axis), second = cross(axis, first);
    const double cosine = cosine_of(c);
    FacePoint points[2][kMostFacePoints];
    int now = 0, size = 4;
    points[0][0] = {-2, -2};
    points[0][1] = {2, -2};
    points[0][2] = {2, 2};
    points[0][3] = {-2, 2};
    const auto clip = [&](const Vec3d& normal, double height) {
      int kept = 0;
      clip_polygon(points[now], static_cast<std::size_t>(size),
                   {dot(normal, first), dot(normal, second)}, height - cosine * dot(normal, axis),
                   [&](const FacePoint& p) {
                     if (kept < kMostFacePoints) points[1 - now][kept++] = p;
                   });
      now = 1 - now;
      size = kept;
    };
    for (int j = 0; j < 3; ++j) {
      if (j != ball) clip(between_contacts(balls_, corner_, polygon_, j, ball), 0);
    }
    for (const Side& s : polygon_.side) clip(-1.0 * s.inward, 0);
    for (int j = 0; j < caps_ && size > 0; ++j) {
      if (j != c) clip(axis_of(j) - axis, cosine_of(j) - cosine);
    }
    double area = 0;
    for (int i = 0; i < size; ++i) {
      area += triangle_in_disk(points[now][i], points[now][i + 1 < size ? i + 1 : 0],
                               (1 - cosine) * (1 + cosine));
    }
    return area;
  }

  const Balls& balls_;
  const Corner* corners_;
  const Arc* arcs_;
  const ArcShape* shapes_;
  std::uint32_t self_;
  const Corner& corner_;
  Polygon polygon_;
  CapAtCorner cap_[kMostCaps];
  Segment segment_[kMostSegments];
  Covered<double> covered_[kMostCaps + 3];
  double turn_[2 * kMostCaps + 6], slide_[2 * kMostCaps + 6];  // of places, by turn
  int caps_ = 0, segments_ = 0, covers_ = 0, places_ = 0;
  mutable bool good_ = true;
  double margin_ = 1;
};

}  // namespace vdwmesh::excluded::elements
