// AccessibleDistance: arcs from covered angles, then the nearest of spheres' feet and arcs.
#include "reference/accessible_distance.hpp"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace vdwmesh::reference {
namespace {

using std::size_t;

constexpr double kTurn = 2 * std::numbers::pi;

// Å: a point on a sphere counts as covered by another ball if it is deeper in it than this, which
// is above the rounding of coordinates below 10⁴ Å.
constexpr double kSlack = 1e-10;

// Shorter arcs, rad, come from rounding where more than three spheres meet in a point. They are
// left out: the longer arcs that end there bring the point.
constexpr double kShortestArc = 1e-9;

Point unit(const Point& p) { return (1 / length(p)) * p; }

Point across(const Point& axis) {
  return unit(outer(axis, std::abs(axis[0]) < 0.5 ? Point{{1, 0, 0}} : Point{{0, 1, 0}}));
}

bool lies_in(const Ball& inner_ball, const Ball& other) {
  return distance(inner_ball.center, other.center) + inner_ball.radius <= other.radius;
}

// Of balls that lie in each other the first one is not swallowed.
bool is_swallowed(const std::vector<Ball>& balls, size_t i) {
  for (size_t j = 0; j < balls.size(); ++j) {
    if (j == i || !lies_in(balls[i], balls[j])) continue;
    if (j < i || !lies_in(balls[j], balls[i])) return true;
  }
  return false;
}

}  // namespace

struct AccessibleDistance::Circle {
  Point center, axis, e1, e2;
  double radius;

  Point at(double angle) const {
    return center + radius * (std::cos(angle) * e1 + std::sin(angle) * e2);
  }
};

AccessibleDistance::Circle AccessibleDistance::circle_of(const Ball& a, const Ball& b) {
  const double d = distance(a.center, b.center);
  const double along = (d * d + a.radius * a.radius - b.radius * b.radius) / (2 * d);
  Circle circle;
  circle.axis = unit(b.center - a.center);
  circle.center = a.center + along * circle.axis;
  circle.e1 = across(circle.axis);
  circle.e2 = outer(circle.axis, circle.e1);
  circle.radius = std::sqrt(std::max(0.0, a.radius * a.radius - along * along));
  return circle;
}

AccessibleDistance::AccessibleDistance(const std::vector<Ball>& atoms, double probe) {
  for (std::uint32_t i = 0; i < atoms.size(); ++i) {
    if (is_swallowed(atoms, i)) continue;
    atoms_.push_back(i);
    balls_.push_back({atoms[i].center, atoms[i].radius + probe});
  }
  for (std::uint32_t i = 0; i < balls_.size(); ++i) add_arcs_of(i);
  all_.covering.resize(balls_.size());
  std::iota(all_.covering.begin(), all_.covering.end(), 0u);
  all_.spheres = all_.covering;
  all_.arcs.resize(arcs_.size());
  std::iota(all_.arcs.begin(), all_.arcs.end(), 0u);
}

// Of a ball and those behind it.
void AccessibleDistance::add_arcs_of(std::uint32_t i) {
  Ids meeting;
  for (std::uint32_t j = 0; j < balls_.size(); ++j) {
    const double d = distance(balls_[i].center, balls_[j].center);
    if (j != i && d < balls_[i].radius + balls_[j].radius) meeting.push_back(j);
  }
  for (const std::uint32_t j : meeting) {
    if (j < i) continue;
    Ids others;
    std::copy_if(meeting.begin(), meeting.end(), std::back_inserter(others),
                 [j](std::uint32_t k) { return k != j; });
    const Circle circle = circle_of(balls_[i], balls_[j]);
    if (circle.radius > 0) add_arcs(circle, others);
  }
}

namespace {

using Angles = std::pair<double, double>;

// The angles, between 0 and 2 π, that are in none of the intervals.
std::vector<Angles> gaps(std::vector<Angles>& covered) {
  std::sort(covered.begin(), covered.end());
  std::vector<Angles> free;
  double reached = 0;
  for (const auto& [begin, end] : covered) {
    if (begin > reached) free.emplace_back(reached, begin);
    reached = std::max(reached, end);
  }
  if (reached < kTurn) free.emplace_back(reached, kTurn);
  const bool through_zero =
      free.size() > 1 && free.front().first == 0 && free.back().second == kTurn;
  if (through_zero) {
    free.front().first = free.back().first - kTurn;
    free.pop_back();
  }
  return free;
}

void add_interval(double begin, double end, std::vector<Angles>& covered) {
  const double turns = kTurn * std::floor(begin / kTurn);
  begin -= turns;
  end -= turns;
  covered.emplace_back(begin, std::min(end, kTurn));
  if (end > kTurn) covered.emplace_back(0, end - kTurn);
}

}  // namespace

// A point of the circle is in ball k where |point - c|² < R², which is m cos(angle - a) < g.
void AccessibleDistance::add_arcs(const Circle& circle, const Ids& covering) {
  std::vector<Angles> covered;
  for (const std::uint32_t k : covering) {
    const Ball& ball = balls_[k];
    const Point from = circle.center - ball.center;
    const double x = inner(from, circle.e1), y = inner(from, circle.e2);
    const double m = 2 * circle.radius * std::hypot(x, y);
    const double g = ball.radius * ball.radius - inner(from, from) - circle.radius * circle.radius;
    const double slack = 2 * ball.radius * kSlack;
    if (g > m + slack) return;  // covered all around
    if (g <= slack - m) continue;
    if (m <= slack) continue;  // the same circle
    const double side = std::acos(std::min(1.0, g / m)), middle = std::atan2(y, x);
    add_interval(middle + side, middle + kTurn - side, covered);
  }
  for (const auto& [begin, end] : gaps(covered)) {
    if (end - begin > kShortestArc) add_arc(circle, begin, end);
  }
}

void AccessibleDistance::add_arc(const Circle& circle, double begin, double end) {
  const double middle = (begin + end) / 2, half = (end - begin) / 2;
  arcs_.push_back({circle.center, circle.axis,
                   std::cos(middle) * circle.e1 + std::sin(middle) * circle.e2, circle.radius,
                   end - begin >= kTurn ? -2 : std::cos(half), circle.at(begin), circle.at(end)});
}

bool AccessibleDistance::is_circle_nearer(const Arc& arc, const Point& at, double far) {
  const Point from = at - arc.center;
  const double along = inner(from, arc.axis);
  if (std::abs(along) >= far) return false;
  const double beside = std::sqrt(std::max(0.0, inner(from, from) - along * along)) - arc.radius;
  return along * along + beside * beside < far * far;
}

NearestAccess AccessibleDistance::nearest_on(const Arc& arc, const Point& at) {
  const Point from = at - arc.center;
  const Point off = from - inner(from, arc.axis) * arc.axis;
  const double reach = length(off);
  if (inner(off, arc.to_middle) >= reach * arc.cosine_of_half) {
    const Point ray = reach > 0 ? (1 / reach) * off : arc.to_middle;
    const Point foot = arc.center + arc.radius * ray;
    return {distance(at, foot), foot, NearestOn::arc};
  }
  const double begin = distance(at, arc.begin), end = distance(at, arc.end);
  return begin < end ? NearestAccess{begin, arc.begin, NearestOn::corner}
                     : NearestAccess{end, arc.end, NearestOn::corner};
}

bool AccessibleDistance::is_covered(const Point& at, const Ids& covering) const {
  return std::any_of(covering.begin(), covering.end(), [&](std::uint32_t k) {
    const double radius = balls_[k].radius - kSlack;
    const Point to = at - balls_[k].center;
    return inner(to, to) < radius * radius;
  });
}

std::vector<std::uint32_t> AccessibleDistance::touched(const Point& place,
                                                       const Candidates& among) const {
  constexpr double kTouch = 1e-6;  // Å: corners are as good as that if arcs meet at flat angles
  std::vector<std::uint32_t> found;
  for (const std::uint32_t k : among.covering) {
    const double depth = balls_[k].radius - distance(place, balls_[k].center);
    if (std::abs(depth) < kTouch) found.push_back(k);
  }
  return found;
}

// A sphere's nearest point is the foot below `at` or, if that is covered, on an arc around what is
// exposed; an arc's is its foot or an end. The nearest of all feet and ends that are exposed is the
// nearest point, because the foot of a ball that does not hold `at` is never the nearest.
NearestAccess AccessibleDistance::nearest(const Point& at, const Candidates& among,
                                          double far) const {
  const auto holds = [&](std::uint32_t k) {
    return distance(at, balls_[k].center) < balls_[k].radius;
  };
  if (std::none_of(among.covering.begin(), among.covering.end(), holds)) {
    return {0, at, NearestOn::nothing};
  }
  NearestAccess best{far, at, NearestOn::nothing};
  for (const std::uint32_t a : among.arcs) {
    if (!is_circle_nearer(arcs_[a], at, best.distance)) continue;
    const NearestAccess found = nearest_on(arcs_[a], at);
    if (found.distance < best.distance) best = found;
  }
  for (const std::uint32_t s : among.spheres) {
    const Ball& ball = balls_[s];
    const Point from = at - ball.center;
    const double off = length(from), depth = ball.radius - off;
    if (depth < 0 || depth >= best.distance) continue;
    const Point foot = ball.center + ball.radius * (off > 0 ? (1 / off) * from : Point{{1, 0, 0}});
    if (!is_covered(foot, among.covering)) best = {depth, foot, NearestOn::sphere};
  }
  return best;
}

// The nearest point of any place in reach is at most `limit` from `middle`.
double AccessibleDistance::narrow(const Candidates& among, const Point& middle, double reach,
                                  Candidates& kept) const {
  const double here = nearest(middle, among).distance, limit = here + 2 * reach + kSlack;
  kept.covering.clear();
  kept.spheres.clear();
  kept.arcs.clear();
  for (const std::uint32_t k : among.covering) {
    if (distance(middle, balls_[k].center) < balls_[k].radius + limit) kept.covering.push_back(k);
  }
  for (const std::uint32_t s : among.spheres) {
    const double depth = balls_[s].radius - distance(middle, balls_[s].center);
    if (std::abs(depth) <= limit) kept.spheres.push_back(s);
  }
  for (const std::uint32_t a : among.arcs) {
    if (!is_circle_nearer(arcs_[a], middle, limit)) continue;
    if (nearest_on(arcs_[a], middle).distance <= limit) kept.arcs.push_back(a);
  }
  return here;
}

}  // namespace vdwmesh::reference
