// The exposed arcs of the circle in which two grown balls meet, in double. For the library's own
// use, on the host and on a CUDA device.
//
// The circle of balls a and b has the axis u from a to b, the centre A and the radius ρ. A ball k
// covers the points A + ρ e(φ) with d · e < q, where d = A - c_k and 2 ρ q = R_k² - |d|² - ρ²: an
// interval of angles about the direction -d. Intervals are sorted, and what none covers is an arc.
// An arc is named by the balls that cover the circle before and behind it.
//
// Nothing is decided that rounding could turn around: a circle on which two ends of intervals are
// nearly one point where an arc ends, or which a ball nearly touches, is left undecided. The
// circles of caps on a probe (cap_arrangement.hpp) are cut in the same way, but their decisions are
// made whatever their margins: a circle of balls has its arcs from the dual complex if double does
// not do.
#pragma once

#include <cmath>
#include <cstdint>

#include "excluded/patches/cap_arrangement.hpp"
#include "spheres/directions.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::excluded::elements {

inline constexpr std::uint32_t kNone = 0xffffffffu;  // in place of a ball, an arc or a corner

// Angles of ends of intervals, in units of a fourth of a turn, are wrong by less than kTurnError
// plus kSlideError over the sine of half the interval.
inline constexpr double kTurnError = 1e-11, kSlideError = 1e-12;
// If the cosine of half an interval differs from 1 or -1 by less than this, rounding decides
// whether the ball covers none or all of the circle.
inline constexpr double kGrazing = 1e-11;
inline constexpr int kMostIntervals = 96;

struct PairCircle {
  Vec3d axis, first, second;  // orthonormal, right-handed; the axis from a to b
  double radius;              // 0: the spheres do not meet
  double height[2];           // signed, of the plane over the centres of a and b
};

VDWMESH_HD inline PairCircle pair_circle(const Sphere& a, const Sphere& b) {
  PairCircle c{};
  const Vec3d to = b.center - a.center;
  const double length = norm(to), ra = a.radius, rb = b.radius;
  const double square =
      (ra + rb + length) * (ra + rb - length) * (length + (ra - rb)) * (length - (ra - rb));
  if (!(square > 0)) return c;
  c.axis = (1 / length) * to;
  c.first = any_orthogonal(c.axis);
  c.second = cross(c.axis, c.first);
  c.radius = std::sqrt(square) / (2 * length);
  const double part = (ra - rb) * (ra + rb);
  c.height[0] = (length * length + part) / (2 * length);
  c.height[1] = (length * length - part) / (2 * length);
  return c;
}

// The part of the circle that a ball covers.
struct CircleInterval {
  double from, to;  // turns, from 0 to 4
  float slack;      // how far both may be wrong
  std::uint32_t ball;
};

enum class Cover : std::uint8_t { none, part, whole, grazing };

// How ball k lies over the circle: d and q of the comment at the top.
struct BallOverCircle {
  double x, y, reach;  // d in the circle's plane, q
};
VDWMESH_HD inline BallOverCircle ball_over_circle(const PairCircle& circle, const Sphere& a,
                                                  const Sphere& k) {
  const Vec3d d = (a.center - k.center) + circle.height[0] * circle.axis;
  const double excess = k.radius * k.radius - squared_norm(d) - circle.radius * circle.radius;
  return {dot(d, circle.first), dot(d, circle.second), excess / (2 * circle.radius)};
}

// Whether a ball covers the whole circle beyond doubt.
VDWMESH_HD inline bool covers_circle(const PairCircle& circle, const Sphere& a, const Sphere& k) {
  const BallOverCircle over = ball_over_circle(circle, a, k);
  const double square = over.x * over.x + over.y * over.y;
  const double scale = k.radius * k.radius;
  return over.reach > 0 && over.reach * over.reach > square * (1 + 4 * kGrazing) + kGrazing * scale;
}

VDWMESH_HD inline Cover cover_circle(const PairCircle& circle, const Sphere& a, const Sphere& k,
                                     CircleInterval& out) {
  const BallOverCircle over = ball_over_circle(circle, a, k);
  const double size = std::sqrt(over.x * over.x + over.y * over.y);
  const double near = kGrazing * (size + k.radius);
  if (over.reach > size + near) return Cover::whole;
  if (over.reach < -size - near) return Cover::none;
  if (!(std::abs(over.reach) < size - near)) return Cover::grazing;
  const double x = -over.x / size, y = -over.y / size, cosine = -over.reach / size;
  const double sine = std::sqrt((1 - cosine) * (1 + cosine));
  out.from = turn_of(cosine * x + sine * y, cosine * y - sine * x);
  out.to = turn_of(cosine * x - sine * y, cosine * y + sine * x);
  out.slack = static_cast<float>(kTurnError + kSlideError / sine * (1 + k.radius / size));
  return Cover::part;
}

// The intervals of one circle.
struct CircleCover {
  CircleInterval interval[kMostIntervals];  // by their beginnings
  int count = 0;
  bool is_covered = false, is_doubtful = false, is_grazed = false;

  VDWMESH_HD void add(const PairCircle& circle, const Sphere& a, const Sphere& k,
                      std::uint32_t ball) {
    CircleInterval made{};
    made.ball = ball;
    const Cover cover = cover_circle(circle, a, k, made);
    is_covered = is_covered || cover == Cover::whole;
    is_grazed = is_grazed || cover == Cover::grazing;
    if (cover != Cover::part || is_inside_other(made)) return;
    if (count == kMostIntervals) {
      is_doubtful = true;
      return;
    }
    int place = count++;
    for (; place > 0 && interval[place - 1].from > made.from; --place) {
      interval[place] = interval[place - 1];
    }
    interval[place] = made;
  }

  // Calls visit(start, end, turns) for each arc, counter-clockwise: the balls that cover the circle
  // before and behind it, and its length. A circle without any interval is one arc between kNone.
  template <class Visit>
  VDWMESH_HD void visit_arcs(const Visit& visit) {
    if (is_covered) return;
    if (count == 0) {
      is_doubtful = is_doubtful || is_grazed;
      visit(kNone, kNone, 4.0);
      return;
    }
    visit_gaps(
        static_cast<std::size_t>(count), [this](std::size_t i) { return interval[i].from; },
        [this](std::size_t i) { return interval[i].to; },
        [&](std::size_t before, std::size_t behind, double gap) {
          if (std::abs(gap) <= interval[behind].slack + interval[before].slack) {
            is_doubtful = true;
          } else if (gap > 0) {
            is_doubtful = is_doubtful || is_grazed ||
                          is_near_other(static_cast<int>(before), static_cast<int>(behind));
            visit(interval[before].ball, interval[behind].ball, gap);
          }
        });
  }

 private:
  VDWMESH_HD static double ahead(double from, double to) {
    return to < from ? to + 4 - from : to - from;
  }
  // Whether an interval lies in another one beyond doubt: then it changes nothing.
  VDWMESH_HD bool is_inside_other(const CircleInterval& c) const {
    for (int i = 0; i < count; ++i) {
      const CircleInterval& other = interval[i];
      const double slack = c.slack + other.slack, begin = ahead(other.from, c.from);
      const double end = begin + ahead(c.from, c.to);
      if (begin > slack && end < ahead(other.from, other.to) - slack) return true;
    }
    return false;
  }
  VDWMESH_HD static bool is_near(double a, double b, double slack) {
    const double apart = std::abs(a - b);
    return apart <= slack || apart >= 4 - slack;
  }
  // Whether some other interval begins or ends, within the slack, where the interval `before` ends
  // or the one `behind` begins.
  VDWMESH_HD bool is_near_other(int before, int behind) const {
    bool near = false;
    for (int i = 0; i < count; ++i) {
      const CircleInterval &c = interval[i], &b = interval[before], &e = interval[behind];
      const double at_start = c.slack + b.slack, at_end = c.slack + e.slack;
      near = near || (i != before && is_near(c.to, b.to, at_start)) ||
             is_near(c.from, b.to, at_start) || (i != behind && is_near(c.from, e.from, at_end)) ||
             is_near(c.to, e.from, at_end);
    }
    return near;
  }
};

}  // namespace vdwmesh::excluded::elements
