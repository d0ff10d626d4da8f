// Climbs by small convex programs. The distance from a centre is convex, so the tangent plane at a
// place lies below it: with u_i the unit vector from centre i to the place and g_i the ball's
// distance,
//   g_i + u_i · step <= distance after the step.
// The step that raises the least of the left sides most raises the clearance at least as much, and
// nowhere on the way is it lower than at the start. At a maximum four balls are at one distance,
// and the steps converge as Newton's method does. Steps end in a ball, not in a cube, so that the
// way turns with the atoms.
#include "pockets/clearance.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace vdwmesh {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// What a step promises of one ball: a distance of at least gap + rise · step.
struct Promise {
  Vec3d rise;  // of length 1
  double gap;
};

double promised(const Promise& p, const Vec3d& step) { return p.gap + dot(p.rise, step); }

// Up to four promises, of which the best step makes equal ones.
struct Basis {
  std::array<std::size_t, 4> members{};
  std::size_t size = 0;
};

// The step of length `reach` at most with which the promises of the basis are equal and greatest:
// the shortest one that makes them equal, and from there on up to the end. NaN or longer than
// `reach` where there is none.
Vec3d step_of(const std::vector<Promise>& all, const Basis& basis, double reach) {
  const auto p = [&](std::size_t k) -> const Promise& { return all[basis.members[k]]; };
  if (basis.size == 1) return reach * p(0).rise;
  const Vec3d a = p(1).rise - p(0).rise;
  const double at_a = p(0).gap - p(1).gap;
  if (basis.size == 2) {
    const Vec3d shortest = at_a / squared_norm(a) * a;
    // The sum of both has no part along a.
    const Vec3d along = p(0).rise + p(1).rise;
    return shortest + std::sqrt(reach * reach - squared_norm(shortest)) / norm(along) * along;
  }
  const Vec3d b = p(2).rise - p(0).rise, n = cross(a, b);
  const double at_b = p(0).gap - p(2).gap;
  const Vec3d shortest = 1 / squared_norm(n) * (at_a * cross(b, n) + at_b * cross(n, a));
  if (basis.size == 3) {
    const double up = std::copysign(1 / norm(n), dot(n, p(0).rise));
    return shortest + up * std::sqrt(reach * reach - squared_norm(shortest)) * n;
  }
  const Vec3d c = p(3).rise - p(0).rise;
  const double at_c = p(0).gap - p(3).gap;
  return 1 / dot(c, n) * (at_a * cross(b, c) + at_b * cross(c, a) + at_c * n);
}

// The least promise of the members.
double least_of(const std::vector<Promise>& all, const Basis& members, const Vec3d& step) {
  double least = kNone;
  for (std::size_t k = 0; k < members.size; ++k) {
    least = std::min(least, promised(all[members.members[k]], step));
  }
  return least;
}

// The best step for the promises of the basis and one more, and the basis that it has: of all steps
// that some of them determine, the one whose least promise is greatest.
std::pair<Basis, Vec3d> extended(const std::vector<Promise>& all, const Basis& basis,
                                 std::size_t more, double reach) {
  std::array<std::size_t, 5> five{};
  std::copy_n(basis.members.begin(), basis.size, five.begin());
  five[basis.size] = more;
  constexpr double kRounding = 1e-12;
  double best = -kNone;
  std::pair<Basis, Vec3d> found{basis, {}};
  for (unsigned subset = 1; subset < 2u << basis.size; ++subset) {
    Basis tried;
    if (std::popcount(subset) > 4) continue;
    for (std::size_t k = 0; k <= basis.size; ++k) {
      if (subset >> k & 1) tried.members[tried.size++] = five[k];
    }
    const Vec3d step = step_of(all, tried, reach);
    if (!(norm(step) <= (1 + kRounding) * reach)) continue;
    const double least = std::min(least_of(all, basis, step), promised(all[more], step));
    if (least > best) best = least, found = {tried, step};
  }
  return found;
}

// The best step of length `reach` at most. It takes in the promise that it breaks most, until it
// breaks none.
Vec3d best_step(const std::vector<Sphere>& balls, const Vec3d& place, double reach) {
  constexpr double kTolerance = 1e-15;
  std::vector<Promise> all;
  for (const Sphere& ball : balls) {
    const Vec3d from = place - ball.center;
    const double distance = norm(from);
    all.push_back({1 / distance * from, distance - ball.radius});
  }
  const auto nearest = std::ranges::min_element(all, {}, &Promise::gap);
  Basis basis{{static_cast<std::size_t>(nearest - all.begin())}, 1};
  Vec3d step = step_of(all, basis, reach);
  for (double last = kNone;;) {
    const double kept = least_of(all, basis, step);
    if (!(kept < last)) return step;  // only rounding is left
    last = kept;
    const auto by_promise = [&](const Promise& p) { return promised(p, step); };
    const auto worst = std::ranges::min_element(all, {}, by_promise);
    if (promised(*worst, step) >= kept - kTolerance) return step;
    std::tie(basis, step) =
        extended(all, basis, static_cast<std::size_t>(worst - all.begin()), reach);
  }
}

// The balls near a place that moves: it looks through a pool, which is gathered anew when the place
// has come too far for it.
class BallPool {
 public:
  BallPool(const std::vector<Sphere>& balls, double slack) : balls_(balls), slack_(slack) {}

  // The balls whose spheres are no farther than `gap`, in their order.
  std::vector<Sphere> within(const Vec3d& place, double gap) {
    if (pool_.empty() || gap + norm(place - middle_) > reach_) {
      middle_ = place;
      reach_ = gap + slack_;
      pool_ = chosen(balls_, middle_, reach_);
    }
    return chosen(pool_, place, gap);
  }

 private:
  static std::vector<Sphere> chosen(const std::vector<Sphere>& from, const Vec3d& place,
                                    double gap) {
    std::vector<Sphere> near;
    for (const Sphere& b : from) {
      if (norm(place - b.center) - b.radius <= gap) near.push_back(b);
    }
    return near;
  }

  const std::vector<Sphere>& balls_;
  const double slack_;
  std::vector<Sphere> pool_;  // those whose spheres are no farther than `reach_` from `middle_`
  Vec3d middle_{};
  double reach_ = 0;
};

}  // namespace

double clearance_at(const std::vector<Sphere>& balls, const Vec3d& place) {
  double least = kNone;
  for (const Sphere& b : balls) least = std::min(least, norm(place - b.center) - b.radius);
  return least;
}

std::optional<ClearPlace> climb_clearance(const std::vector<Sphere>& balls, const Vec3d& start,
                                          double ceiling, std::vector<ClearPlace>* trail) {
  // Of the largest radius: small, because a long step may reach another summit over a pass.
  constexpr double kReach = 0.02;
  constexpr double kConverged = 1e-14;
  constexpr int kMostSteps = 1000;
  double largest = 0;
  for (const Sphere& b : balls) largest = std::max(largest, b.radius);
  const double longest = kReach * largest;
  BallPool pool(balls, largest);
  ClearPlace at{start, clearance_at(balls, start)};
  for (int i = 0; i < kMostSteps; ++i) {
    if (trail) trail->push_back(at);
    if (at.clearance >= ceiling) return at;
    // No ball farther than this is nearer after the step than what is nearest now: both its
    // distance and the clearance change by at most the length of the step.
    const std::vector<Sphere> near = pool.within(at.place, at.clearance + 2 * longest);
    const Vec3d step = best_step(near, at.place, longest);
    const ClearPlace next{at.place + step, clearance_at(near, at.place + step)};
    if (!(next.clearance > at.clearance) || norm(step) < kConverged * largest) return at;
    at = next;
  }
  return std::nullopt;
}

// In the plane, with the first centre as origin, e and f along and across the edge to the second:
// the differences of |x - c_i| = q + R_i squared are linear, so x = p + q v, and the first equation
// is a quadratic one for q.
std::optional<ClearPlace> gate_place(const std::array<Sphere, 3>& balls) {
  const Vec3d ab = balls[1].center - balls[0].center, ac = balls[2].center - balls[0].center;
  const double length = norm(ab);
  const Vec3d e = 1 / length * ab;
  const double cx = dot(ac, e);
  const Vec3d across = ac - cx * e;
  const double cy = norm(across);
  const double r0 = balls[0].radius, r1 = balls[1].radius, r2 = balls[2].radius;
  const double px = (length * length + (r0 - r1) * (r0 + r1)) / (2 * length);
  const double vx = (r0 - r1) / length;
  const double py = ((cx * cx + cy * cy + (r0 - r2) * (r0 + r2)) / 2 - cx * px) / cy;
  const double vy = ((r0 - r2) - cx * vx) / cy;
  // (p + q v)² = (q + R)²
  const double a = vx * vx + vy * vy - 1, b = px * vx + py * vy - r0,
               c = px * px + py * py - r0 * r0;
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0)) return std::nullopt;
  // Both roots without cancellation; the wanted one is the least that reaches all three balls.
  const double half = -(b + std::copysign(std::sqrt(discriminant), b));
  const double least = -std::min({r0, r1, r2});
  std::optional<double> best;
  for (const double q : {half / a, c / half}) {
    if (std::isfinite(q) && q >= least && (!best || q < *best)) best = q;
  }
  if (!best) return std::nullopt;
  const Vec3d f = 1 / cy * across;
  return ClearPlace{balls[0].center + (px + *best * vx) * e + (py + *best * vy) * f, *best};
}

}  // namespace vdwmesh
