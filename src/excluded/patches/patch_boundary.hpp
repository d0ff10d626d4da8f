// The boundary of a concave patch: the parts of its circles that no cap covers, and the loops that
// they make. For the library's own use, on the host and on a CUDA device.
//
// Each cap's circle is cut by the other caps. A part that no cap covers is a segment of the
// boundary if it lies in the polygon of the sides. A side is a segment too; the side of a spindle
// is two, without the part between its cusps. A circle leaves the polygon through cusps alone,
// where it is cut. So one point of a part tells whether all of it lies in the polygon.
#pragma once

#include "core/no_index.hpp"
#include "excluded/patches/cut_patch.hpp"

namespace vdwmesh::excluded {

// Scalar products of a patch in bounded lists have fma, as those of Vec3d do.
template <class Lists, class T>
VDWMESH_HD T inner_product(const Vector<T>& a, const Vector<T>& b) {
  if constexpr (std::is_same_v<Lists, BoundedLists>) {
    return dot(to_vec(a), to_vec(b));
  } else {
    return dot(a, b);
  }
}

template <class T, class Lists>
class SegmentFinder {
 public:
  VDWMESH_HD SegmentFinder(CutPatch<Lists>& patch, const PatchCircles<T, Lists>& circles)
      : patch_(patch), circles_(circles) {}

  VDWMESH_HD double find() {
    patch_.segments.clear();
    for (std::uint32_t c = 0; c < caps(); ++c) cut_circle(c);
    add_sides();
    return margin_;
  }

 private:
  static constexpr int kMostCovers = kMostCaps + kMostSides;
  // If the depth of a point (polygon_depth()) is larger than this, or below its negative, no other
  // point of the part is tested.
  static constexpr double kDeep = 1e-6;

  VDWMESH_HD std::uint32_t caps() const { return patch_.cap_count(); }

  VDWMESH_HD void cut_circle(std::uint32_t c) {
    const CapCircle<T>& circle = circles_.caps[c];
    covered_.clear();
    const std::uint32_t count = caps();
    for (std::uint32_t j = 0; j < count; ++j) {
      if (j == c) continue;
      CoveredArc<T> part;
      const Overlap overlap = covered_part(circle, circles_.caps[j], j, part, margin_);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) covered_.push_back(part);
    }
    const T radius = circle_radius(circle.cosine);
    for (std::uint32_t s = 0; s < patch_.sides.size(); ++s) {
      if (patch_.sides[s].gap != c) continue;
      const auto& cusp = circles_.sides[s].cusp;
      const double slide = 1 / to_double(radius);
      covered_.push_back(
          {place_on(circle, cusp[0], slide), place_on(circle, cusp[1], slide), caps() + s});
    }
    if (covered_.empty()) {
      const Vector<T> point = combination(circle.cosine, circle.axis, radius, circle.first);
      if (!is_inside(polygon_depth(c, point))) return;
      const Vec3d at = to_vec(point);
      patch_.segments.push_back({.before = kNoIndex,
                                 .circle = c,
                                 .next = kNoIndex,
                                 .piece = 0,
                                 .angle = 2 * std::numbers::pi,
                                 .from = at,
                                 .to = at,
                                 .turning = 0});
      return;
    }
    visit_uncovered<Lists, kMostCovers>(covered_, margin_,
                                        [&](const CoveredArc<T>& behind, const CoveredArc<T>& ahead,
                                            double angle) { add_part(c, behind, ahead, angle); });
  }

  // A segment runs clockwise about the cap's axis, an uncovered part counter-clockwise.
  VDWMESH_HD void add_part(std::uint32_t c, const CoveredArc<T>& behind, const CoveredArc<T>& ahead,
                           double angle) {
    const Vector<T>&from = ahead.from.point, &to = behind.to.point;
    // One tested point may lie on a side, where the depth says nothing, but not several.
    double depth = 0;
    for (int i = 0; i < 3; ++i) {
      const double fraction = i == 0 ? 0.5 : (i == 1 ? 0.3 : 0.8);
      const double here = polygon_depth(c, point_beyond(circles_.caps[c], to, fraction * angle));
      if (std::abs(here) > std::abs(depth)) depth = here;
      if (std::abs(depth) > kDeep) break;
    }
    if (!is_inside(depth)) return;
    patch_.segments.push_back({.before = ahead.by,
                               .circle = c,
                               .next = behind.by,
                               .piece = 0,
                               .angle = angle,
                               .from = to_vec(from),
                               .to = to_vec(to),
                               .turning = turning_between(c, behind.by, to)});
  }

  // How deep a point of circle c is in the polygon: its distance from the plane of the nearest
  // side, negative outside. A side whose cusps are on the circle is left out, because the circle
  // was cut there.
  VDWMESH_HD double polygon_depth(std::uint32_t c, const Vector<T>& point) const {
    double least = 1;
    const std::size_t count = patch_.sides.size();
    for (std::size_t s = 0; s < count; ++s) {
      if (patch_.sides[s].gap == c) continue;
      least = std::min(least, to_double(inner_product<Lists>(circles_.sides[s].inward, point)));
    }
    return least;
  }

  VDWMESH_HD bool is_inside(double depth) {
    margin_ = std::min(margin_, std::abs(depth));
    return depth > 0;
  }

  VDWMESH_HD Vector<T> axis_of(std::uint32_t circle) const {
    if (circle < caps()) return circles_.caps[circle].axis;
    const Vector<T>& v = circles_.sides[circle - caps()].inward;
    return {-v.x, -v.y, -v.z};
  }
  VDWMESH_HD T cosine_of(std::uint32_t circle) const {
    return circle < caps() ? circles_.caps[circle].cosine : T(0);
  }

  // The exterior angle where the boundary goes over from circle i to circle j.
  VDWMESH_HD double turning_between(std::uint32_t i, std::uint32_t j,
                                    const Vector<T>& point) const {
    const Vector<T> a = axis_of(i), b = axis_of(j);
    const double sine = to_double(inner_product<Lists>(point, cross(a, b)));
    return std::atan2(sine > 0 ? sine : 0,
                      to_double(T(inner_product<Lists>(a, b) - cosine_of(i) * cosine_of(j))));
  }

  // The number of the side that begins or ends where side s ends or begins.
  VDWMESH_HD std::uint32_t side_at(const PatchSide& side, std::size_t end) const {
    for (std::uint32_t i = 0; i < patch_.sides.size(); ++i) {
      if (patch_.sides[i].atom[1 - end] == side.atom[end]) return caps() + i;
    }
    return kNoIndex;
  }

  VDWMESH_HD void add_sides() {
    for (std::uint32_t s = 0; s < patch_.sides.size(); ++s) {
      const PatchSide& side = patch_.sides[s];
      const std::uint32_t self = caps() + s, before = side_at(side, 0), next = side_at(side, 1);
      const PatchSegment whole{.before = before,
                               .circle = self,
                               .next = next,
                               .piece = 0,
                               .angle = side.angle[0] + side.angle[1],
                               .from = side.contact[0],
                               .to = side.contact[1],
                               .turning = side.turning};
      if (!side.spindle) {
        patch_.segments.push_back(whole);
        continue;
      }
      PatchSegment first = whole, second = whole;  // up to the gap, and after it
      first.next = second.before = side.gap;
      first.angle = side.angle[0], second.angle = side.angle[1];
      first.to = side.cusp[0], second.from = side.cusp[1];
      first.turning = turning_between(self, side.gap, circles_.sides[s].cusp[0]);
      patch_.segments.push_back(first);
      patch_.segments.push_back(second);
    }
  }

  CutPatch<Lists>& patch_;
  const PatchCircles<T, Lists>& circles_;
  typename Lists::template List<CoveredArc<T>, kMostCovers> covered_;
  double margin_ = 1;
};

// Finds the segments of a patch whose sides and caps are known. Returns the smallest margin of its
// decisions: how far circles have to move on the unit sphere to turn one of them around.
template <class T, class Lists>
VDWMESH_HD double find_segments(CutPatch<Lists>& patch, const PatchCircles<T, Lists>& circles) {
  return SegmentFinder<T, Lists>(patch, circles).find();
}

// ½ ∫ w × dw along a segment.
template <class Lists>
VDWMESH_HD Vec3d segment_vector(const CutPatch<Lists>& patch, const PatchSegment& s) {
  const Vec3d axis = patch.axis_of(s.circle);
  const double h = patch.cosine_of(s.circle), squared_sine = (1 - h) * (1 + h);
  return -0.5 * ((squared_sine * s.angle) * axis - h * cross(axis, s.to - s.from));
}

// ∫ w dψ along a segment of a cap's circle, with the angle ψ about the cap's axis.
template <class Lists>
VDWMESH_HD Vec3d segment_integral(const CutPatch<Lists>& patch, const PatchSegment& s) {
  const Vec3d axis = patch.axis_of(s.circle);
  return (patch.cosine_of(s.circle) * s.angle) * axis + cross(axis, s.to - s.from);
}

// Chains the segments to loops by the names of the circles that meet in their ends, and numbers the
// loops in PatchSegment::piece. Calls on_segment(segment) for the segments of a loop, then
// on_loop(solid_angle, is_hole). Returns whether all loops close.
//
// Gauss–Bonnet gives the area on the left of each loop as if it bounded a disk: 2 π + Σ φ h - Σ ε,
// with the angles φ of the segments, the cosines h of their circles and the exterior angles ε. The
// polygon of all sides is a disk in a hemisphere. So a loop with a segment of a side bounds a piece
// from outside. A loop of caps alone is the rim of a hole if the area on its left is 2 π or more.
// The solid angle of a hole is the area less 4 π.
template <class Lists, class OnSegment, class OnLoop>
VDWMESH_HD bool chain_loops(CutPatch<Lists>& patch, const OnSegment& on_segment,
                            const OnLoop& on_loop) {
  // Solid angle. It is far more than the rounding of a loop's area, and far less than a hemisphere
  // has beside a piece that caps alone bound.
  constexpr double kRounding = 1e-6, kTurn = 2 * std::numbers::pi;
  const auto size = static_cast<std::uint32_t>(patch.segments.size());
  const auto successor = [&](const PatchSegment& s) {
    for (std::uint32_t i = 0; i < size; ++i) {
      const PatchSegment& other = patch.segments[i];
      if (other.circle == s.next && other.before == s.circle) return i;
    }
    return kNoIndex;
  };
  for (PatchSegment& s : patch.segments) s.piece = kNoIndex;
  bool closes = true;
  std::uint32_t loop = 0;
  for (std::uint32_t first = 0; first < size; ++first) {
    if (patch.segments[first].piece != kNoIndex) continue;
    double solid_angle = kTurn;
    bool is_hole = true;
    std::uint32_t i = first;
    while (i != kNoIndex && patch.segments[i].piece == kNoIndex) {
      PatchSegment& s = patch.segments[i];
      s.piece = loop;
      solid_angle += s.angle * patch.cosine_of(s.circle) - s.turning;
      on_segment(s);
      is_hole = is_hole && s.circle < patch.cap_count();
      i = s.is_whole() ? first : successor(s);
    }
    closes = closes && i == first;
    is_hole = is_hole && solid_angle > kTurn - kRounding;
    on_loop(is_hole ? solid_angle - 2 * kTurn : solid_angle, is_hole);
    ++loop;
  }
  return closes;
}

}  // namespace vdwmesh::excluded
