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
#include <limits>
#include <vector>

#include "complex/number_vector.hpp"
#include "core/vec3.hpp"

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

// A point of a circle: where it is about the axis. x and y are its coordinates along the circle's
// `first` and `second`. `turn` stands for its angle and takes no trigonometry: it is the way to the
// point along the square |x| + |y| = 1, in sides of the square, and rises from 0 to 4 in a whole
// turn. It changes by `slide` for each radian by which circles move.
template <class T>
struct CirclePlace {
  T x, y, turn;
  Vector<T> point;
  double slide;
};

template <class T>
VDWMESH_HD CirclePlace<T> place_on(const CapCircle<T>& circle, const Vector<T>& w, double slide) {
  using std::abs;
  const T x = dot(w, circle.first), y = dot(w, circle.second);
  const T size = abs(x) + abs(y);
  const T part = x / size;
  return {x, y, y < T(0) ? T(3 + part) : T(1 - part), w, slide};
}

// The part of a circle that another cap covers.
template <class T>
struct Covered {
  CirclePlace<T> from, to;
  std::uint32_t by;
};

// A part of a circle that no cap covers, counter-clockwise.
template <class T>
struct Uncovered {
  Covered<T> behind, ahead;  // it runs from behind.to to ahead.from
  double angle;
};

enum class Overlap { none, crossing, whole };

// Which part of circle c cap j covers. Lowers `margin` to the margin of this decision if that is
// smaller.
template <class T>
VDWMESH_HD Overlap covered_part(const CapCircle<T>& c, const CapCircle<T>& j, std::uint32_t by,
                                Covered<T>& part, double& margin) {
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

// The margin of the order of places about a circle.
template <class T>
double order_margin(const std::vector<Covered<T>>& covered) {
  struct Place {
    T turn;
    double slide;
  };
  std::vector<Place> places;
  for (const Covered<T>& c : covered) {
    places.push_back({c.from.turn, c.from.slide});
    places.push_back({c.to.turn, c.to.slide});
  }
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return a.turn < b.turn; });
  double margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const bool last = i + 1 == places.size();
    const Place &a = places[i], &b = places[last ? 0 : i + 1];
    const T ahead = last ? T(b.turn + T(4)) : b.turn;
    margin = std::min(margin, to_double(T(ahead - a.turn)) / (a.slide + b.slide));
  }
  return margin;
}

// The parts of a circle between its covered parts. Precondition: there is at least one of these.
template <class T>
std::vector<Uncovered<T>> uncovered_parts(std::vector<Covered<T>> covered, double& margin) {
  margin = std::min(margin, order_margin(covered));
  std::sort(covered.begin(), covered.end(),
            [](const Covered<T>& a, const Covered<T>& b) { return a.from.turn < b.from.turn; });
  // Goes around twice. After the first turn, `reach` is the farthest end of all parts that have
  // begun.
  std::vector<Uncovered<T>> parts;
  std::size_t farthest = covered.size();
  T reach(0);
  for (std::size_t step = 0; step < 2 * covered.size(); ++step) {
    const std::size_t i = step % covered.size();
    const bool second = step >= covered.size();
    const Covered<T>& c = covered[i];
    const T start = second ? T(c.from.turn + T(4)) : c.from.turn;
    if (second && start > reach) {
      const T turns = start - reach;
      parts.push_back({covered[farthest], c, angle_between(covered[farthest].to, c.from, turns)});
    }
    T stop = second ? T(c.to.turn + T(4)) : c.to.turn;
    if (stop < start) stop += T(4);
    if (farthest == covered.size() || stop > reach) {
      reach = stop;
      farthest = i;
    }
  }
  return parts;
}

}  // namespace vdwmesh::excluded
