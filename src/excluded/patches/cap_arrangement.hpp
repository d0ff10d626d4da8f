// The circles of caps on the unit sphere, and the arcs of them that no cap covers, in any number
// type. For the library's own use.
//
// A circle i has the axis n_i and the cosine h_i: n_i · w = h_i. With
//
//   d = n_j - n_i      q = |d|² / 2
//   m = d + q n_i      in the plane of both axes, at right angles to n_i
//   c = n_i × n_j      at right angles to both axes
//   t = h_j - (n_i · n_j) h_i = h_j - h_i + q h_i
//   g² = (1 - h_i²) |c|² - t²
//
// two circles cross in the points w = h_i n_i + (t m ± g c) / |c|²: the middle of their common
// chord is h_i n_i + t m / |c|², and half of the chord is g c / |c|². The differences d and h_j -
// h_i keep the digits of circles that are nearly the same. Seen from circle i, cap j covers the
// interval that runs counter-clockwise about n_i from the point with -g to that with +g.
//
// Every decision has a margin: how far, to first order, circles have to move on the sphere to
// reverse it. If they move by η, t and |c| change by up to η each. Since g² is a difference of
// squares of at most |c| and |t|, it changes by up to 2 η (|t| + |c|), and the place of w about n_i
// by up to 2 η / g.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "complex/number_vector.hpp"
#include "core/vec3.hpp"
#include "excluded/patches/bounded_list.hpp"

namespace vdwmesh::excluded {

using numbers::Vector;

VDWMESH_HD inline double to_double(double x) { return x; }
template <class T>
VDWMESH_HD double to_double(const T& x) {
  return static_cast<double>(x);
}
template <class T>
VDWMESH_HD Vector<T> combination(const T& a, const Vector<T>& u, const T& b, const Vector<T>& v) {
  return {a * u.x + b * v.x, a * u.y + b * v.y, a * u.z + b * v.z};
}
template <class T>
VDWMESH_HD Vector<T> vector_in(const Vec3d& v) {
  return {T(v.x), T(v.y), T(v.z)};
}
template <class T>
VDWMESH_HD Vec3d to_vec(const Vector<T>& v) {
  return {to_double(v.x), to_double(v.y), to_double(v.z)};
}

// Other number types specialize it where theirs is slow.
template <class T>
VDWMESH_HD T root_of(const T& x) {
  using std::sqrt;
  return sqrt(x);
}

template <class T>
struct CapCircle {
  Vector<T> axis, first, second;  // orthonormal, right-handed
  T cosine;
};

// The radius of the circle: sqrt(1 - x²), or 0 if rounding made x larger than 1. So it also makes a
// cosine, but for its sign, of a sine.
template <class T>
VDWMESH_HD T circle_radius(const T& x) {
  const T square = (T(1) - x) * (T(1) + x);
  return square > T(0) ? root_of(square) : T(0);
}

template <class T>
VDWMESH_HD CapCircle<T> cap_circle(const Vector<T>& axis, const T& cosine) {
  using std::abs;
  const T x = abs(axis.x), y = abs(axis.y), z = abs(axis.z);
  Vector<T> far{T(0), T(0), T(0)};
  (x <= y && x <= z ? far.x : (y <= z ? far.y : far.z)) = T(1);
  Vector<T> first = cross(axis, far);
  const T scale = T(1) / root_of(T(dot(first, first)));
  first = {scale * first.x, scale * first.y, scale * first.z};
  return {axis, first, cross(axis, first), cosine};
}

// The point at an angle counter-clockwise about the circle's axis from `start`, a point of it.
template <class T>
VDWMESH_HD Vector<T> point_beyond(const CapCircle<T>& circle, const Vector<T>& start,
                                  double angle) {
  // The sine is rounded to double, and the cosine made so that the point is on the circle in T.
  const T sine(std::sin(angle)), size = circle_radius(sine);
  const T cosine = std::cos(angle) < 0 ? T(-size) : size;
  const Vector<T> arm = combination(T(1), start, T(-circle.cosine), circle.axis);
  const Vector<T> turned = combination(cosine, arm, sine, cross(circle.axis, arm));
  return combination(circle.cosine, circle.axis, T(1), turned);
}

// Stands for the angle of a point about the origin and takes no trigonometry: it is the way to the
// point along the square |x| + |y| = 1, in sides of the square, and rises from 0 to 4 in a whole
// turn.
template <class T>
VDWMESH_HD T turn_of(const T& x, const T& y) {
  using std::abs;
  const T part = x / T(abs(x) + abs(y));
  return y < T(0) ? T(3 + part) : T(1 - part);
}

// A point of a circle: where it is about the axis. x and y are its coordinates along the circle's
// `first` and `second`. Its `turn` changes by `slide` for each radian by which circles move.
template <class T>
struct CirclePlace {
  T x, y, turn;
  Vector<T> point;
  double slide;
};

template <class T>
VDWMESH_HD CirclePlace<T> place_on(const CapCircle<T>& circle, const Vector<T>& w, double slide) {
  const T x = dot(w, circle.first), y = dot(w, circle.second);
  return {x, y, turn_of(x, y), w, slide};
}

// The part of a circle that another cap covers.
template <class T>
struct CoveredArc {
  CirclePlace<T> from, to;
  std::uint32_t by;
};

enum class Overlap { none, crossing, whole };

// Which part of circle c cap j covers. Lowers `margin` to the margin of this decision if that is
// smaller.
template <class T>
VDWMESH_HD Overlap covered_part(const CapCircle<T>& c, const CapCircle<T>& j, std::uint32_t by,
                                CoveredArc<T>& part, double& margin) {
  // In the letters of the head, with c as circle i: d, c, q, |c|², t and g².
  const Vector<T> apart = combination(T(1), j.axis, T(-1), c.axis), side = cross(c.axis, apart);
  const T q = dot(apart, apart) / T(2), squared_sine = dot(side, side);
  const T toward = (j.cosine - c.cosine) + q * c.cosine;
  const T gram = (T(1) - c.cosine) * (T(1) + c.cosine) * squared_sine - toward * toward;
  const double change = 2 * (std::abs(to_double(toward)) + std::sqrt(to_double(squared_sine)));
  margin = std::min(margin, change > 0 ? std::abs(to_double(gram)) / change : 0);
  if (!(gram > T(0))) return toward < T(0) ? Overlap::whole : Overlap::none;
  const T root = root_of(gram), scale = T(1) / squared_sine, half_chord = root * scale;
  const double slide = 2 / to_double(root);
  const Vector<T> across = combination(T(1), apart, q, c.axis);
  const Vector<T> middle = combination(c.cosine, c.axis, T(toward * scale), across);
  part = {place_on(c, combination(T(1), middle, T(-half_chord), side), slide),
          place_on(c, combination(T(1), middle, half_chord, side), slide), by};
  return Overlap::crossing;
}

// The angle from `from` counter-clockwise to `to`. `turns` is roughly this angle, in fourths of a
// turn. Near 0, rounding may give the angle the wrong sign. There `turns` tells nearly nothing from
// nearly a whole turn.
template <class T>
VDWMESH_HD double angle_between(const CirclePlace<T>& from, const CirclePlace<T>& to,
                                const T& turns) {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  const double angle = std::atan2(to_double(T(from.x * to.y - from.y * to.x)),
                                  to_double(T(from.x * to.x + from.y * to.y)));
  constexpr double kClose = 1e-3;
  if (std::abs(angle) < kClose) return turns > T(2) ? kTurn + angle : std::abs(angle);
  return angle < 0 ? angle + kTurn : angle;
}

// Lowers `margin` to that of the order of all places about a circle, if that is smaller.
template <class Lists, int kMost, class Covers>
VDWMESH_HD void narrow_by_order(const Covers& covered, double& margin) {
  using T = std::remove_cvref_t<decltype(covered[0].from.turn)>;
  struct TurnAndSlide {
    T turn;
    double slide;
  };
  typename Lists::template List<TurnAndSlide, 2 * kMost> places;
  for (const CoveredArc<T>& c : covered) {
    places.push_back({c.from.turn, c.from.slide});
    places.push_back({c.to.turn, c.to.slide});
  }
  Lists::sort(places, [](const TurnAndSlide& a, const TurnAndSlide& b) { return a.turn < b.turn; });
  const std::size_t size = places.size();
  for (std::size_t i = 0; i < size; ++i) {
    const bool last = i + 1 == size;
    const TurnAndSlide &a = places[i], &b = places[last ? 0 : i + 1];
    const T ahead = last ? T(b.turn + T(4)) : b.turn;
    const double here = to_double(T(ahead - a.turn)) / (a.slide + b.slide);
    if (!(here >= margin)) margin = here;  // also if it is not a number
  }
}

// Goes around a circle with `count` covered intervals, in the order of their beginnings. Calls
// visit(before, behind, gap) for each interval `behind` and, of those that begin before it, the one
// that reaches farthest. The circle is uncovered between the two if `gap`, in turns, is above 0.
// from(i) and to(i) are the turns of the intervals' ends.
template <class From, class To, class Visit>
VDWMESH_HD void visit_gaps(std::size_t count, const From& from, const To& to, const Visit& visit) {
  using T = std::remove_cvref_t<decltype(from(count))>;
  // Goes around twice. After the first turn, `reach` is the farthest end of all intervals that have
  // begun.
  std::size_t farthest = count;
  T reach(0);
  for (std::size_t step = 0; step < 2 * count; ++step) {
    const bool second = step >= count;
    const std::size_t i = second ? step - count : step;
    const T start = second ? T(from(i) + T(4)) : T(from(i));
    if (second) visit(farthest, i, T(start - reach));
    T stop = second ? T(to(i) + T(4)) : T(to(i));
    if (stop < start) stop += T(4);
    if (farthest == count || stop > reach) {
      reach = stop;
      farthest = i;
    }
  }
}

// Sorts the covered parts of a circle, at most kMost, and calls visit(behind, ahead, angle) for
// each part between them: it runs counter-clockwise from behind.to to ahead.from.
template <class Lists, int kMost, class Covers, class Visit>
VDWMESH_HD void visit_uncovered(Covers& covered, double& margin, const Visit& visit) {
  using Part = std::remove_cvref_t<decltype(covered[0])>;
  narrow_by_order<Lists, kMost>(covered, margin);
  Lists::sort(covered, [](const Part& a, const Part& b) { return a.from.turn < b.from.turn; });
  visit_gaps(
      covered.size(), [&](std::size_t i) { return covered[i].from.turn; },
      [&](std::size_t i) { return covered[i].to.turn; },
      [&](std::size_t before, std::size_t behind, const auto& turns) {
        if (!(turns > 0)) return;
        visit(covered[before], covered[behind],
              angle_between(covered[before].to, covered[behind].from, turns));
      });
}

}  // namespace vdwmesh::excluded
