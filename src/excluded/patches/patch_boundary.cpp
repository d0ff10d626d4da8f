// find_segments(): each cap's circle is cut by the other caps. A part that no cap covers is a
// segment of the boundary if it lies in the polygon of the sides. A side is a segment too; the side
// of a spindle is two, without the part between its cusps.
//
// A circle leaves the polygon through cusps alone, where it is cut. So one point of a part tells
// whether all of it lies in the polygon.
#include "excluded/patches/patch_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vdwmesh::excluded {
namespace {

// If the depth of a point (polygon_depth()) is larger than this, or below its negative, no other
// point of the part is tested.
constexpr double kDeep = 1e-6;

template <class T>
class SegmentFinder {
 public:
  SegmentFinder(ConcavePatch& patch, const PatchCircles<T>& circles)
      : patch_(patch), circles_(circles) {}

  double find() {
    patch_.segments.clear();
    for (std::uint32_t c = 0; c < cap_count(); ++c) cut_circle(c);
    add_sides();
    return margin_;
  }

 private:
  std::uint32_t cap_count() const { return static_cast<std::uint32_t>(circles_.caps.size()); }

  void cut_circle(std::uint32_t c) {
    const CapCircle<T>& circle = circles_.caps[c];
    std::vector<Covered<T>> covered;
    for (std::uint32_t j = 0; j < cap_count(); ++j) {
      if (j == c) continue;
      Covered<T> part;
      const Overlap overlap = covered_part(circle, circles_.caps[j], j, part, margin_);
      if (overlap == Overlap::whole) return;
      if (overlap == Overlap::crossing) covered.push_back(part);
    }
    const T radius = circle_radius(circle.cosine);
    for (std::uint32_t s = 0; s < patch_.sides.size(); ++s) {
      if (patch_.sides[s].gap != c) continue;
      const auto& [first, second] = circles_.sides[s].cusp;
      const double slide = 1 / to_double(radius);
      covered.push_back(
          {place_on(circle, first, slide), place_on(circle, second, slide), cap_count() + s});
    }
    if (covered.empty()) {
      const Vector<T> point = combination(circle.cosine, circle.axis, radius, circle.first);
      if (is_inside(polygon_depth(c, point))) {
        const Vec3d at = to_vec(point);
        patch_.segments.push_back({kNoIndex, c, kNoIndex, 0, 2 * std::numbers::pi, at, at, 0});
      }
      return;
    }
    for (const Uncovered<T>& part : uncovered_parts(covered, margin_)) add_arc(c, part);
  }

  // A segment runs clockwise about the cap's axis, an uncovered part counter-clockwise.
  void add_arc(std::uint32_t c, const Uncovered<T>& part) {
    const Vector<T>& from = part.ahead.from.point;
    const Vector<T>& to = part.behind.to.point;
    // One tested point may lie on a side, where the depth says nothing, but not several.
    double depth = 0;
    for (const double fraction : {0.5, 0.3, 0.8}) {
      const double here =
          polygon_depth(c, point_beyond(circles_.caps[c], to, fraction * part.angle));
      if (std::abs(here) > std::abs(depth)) depth = here;
      if (std::abs(depth) > kDeep) break;
    }
    if (!is_inside(depth)) return;
    const std::uint32_t next = part.behind.by;
    patch_.segments.push_back({part.ahead.by, c, next, 0, part.angle, to_vec(from), to_vec(to),
                               turning_between(c, next, to)});
  }

  // How deep a point of circle c is in the polygon: its distance from the plane of the nearest
  // side, negative outside. A side whose cusps are on the circle is left out, because the circle
  // was cut there.
  double polygon_depth(std::uint32_t c, const Vector<T>& point) const {
    double least = 1;
    for (std::size_t s = 0; s < patch_.sides.size(); ++s) {
      if (patch_.sides[s].gap == c) continue;
      least = std::min(least, to_double(T(dot(circles_.sides[s].inward, point))));
    }
    return least;
  }

  bool is_inside(double depth) {
    margin_ = std::min(margin_, std::abs(depth));
    return depth > 0;
  }

  Vector<T> axis_of(std::uint32_t circle) const {
    if (circle < cap_count()) return circles_.caps[circle].axis;
    const Vector<T>& v = circles_.sides[circle - cap_count()].inward;
    return {-v.x, -v.y, -v.z};
  }
  T cosine_of(std::uint32_t circle) const {
    return circle < cap_count() ? circles_.caps[circle].cosine : T(0);
  }

  // The exterior angle where the boundary goes over from circle i to circle j.
  double turning_between(std::uint32_t i, std::uint32_t j, const Vector<T>& point) const {
    const Vector<T> a = axis_of(i), b = axis_of(j);
    const double sine = std::max(0.0, to_double(T(dot(point, cross(a, b)))));
    return std::atan2(sine, to_double(T(dot(a, b) - cosine_of(i) * cosine_of(j))));
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
      const double turning = turning_between(self, side.gap, circles_.sides[s].cusp[0]);
      patch_.segments.push_back(
          {before, self, side.gap, 0, side.angle[0], from, side.cusp[0], turning});
      patch_.segments.push_back(
          {side.gap, self, next, 0, side.angle[1], side.cusp[1], to, side.turning});
    }
  }

  ConcavePatch& patch_;
  const PatchCircles<T>& circles_;
  double margin_ = 1;
};

}  // namespace

template <class T>
double find_segments(ConcavePatch& patch, const PatchCircles<T>& circles) {
  return SegmentFinder<T>(patch, circles).find();
}

template double find_segments(ConcavePatch& patch, const PatchCircles<double>& circles);
template double find_segments(ConcavePatch& patch, const PatchCircles<WideFloat>& circles);

}  // namespace vdwmesh::excluded
