// Climbs by linear programs. The distance from a centre is convex, so the tangent plane at a place
// lies below it: with u_i the unit vector from centre i to the place and g_i the ball's distance,
//   g_i + u_i · step <= distance after the step.
// The step that raises the least of the left sides most raises the clearance at least as much, and
// nowhere on the way is it lower than at the start. At a maximum four balls are at one distance,
// and the steps converge as Newton's method does.
#include "pockets/clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdwmesh {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

// row · (step, clearance) <= bound.
struct HalfSpace {
  std::array<double, 4> row;
  double bound;
};

double product(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

// Solves matrix × result = right by elimination with pivots; NaN if the matrix is singular.
std::array<double, 4> solve(std::array<std::array<double, 4>, 4> matrix,
                            std::array<double, 4> right) {
  for (std::size_t k = 0; k < 4; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 4; ++i) {
      if (std::abs(matrix[i][k]) > std::abs(matrix[pivot][k])) pivot = i;
    }
    std::swap(matrix[k], matrix[pivot]);
    std::swap(right[k], right[pivot]);
    for (std::size_t i = k + 1; i < 4; ++i) {
      const double factor = matrix[i][k] / matrix[k][k];
      for (std::size_t j = k; j < 4; ++j) matrix[i][j] -= factor * matrix[k][j];
      right[i] -= factor * right[k];
    }
  }
  for (std::size_t k = 4; k-- > 0;) {
    for (std::size_t j = k + 1; j < 4; ++j) right[k] -= matrix[k][j] * right[j];
    right[k] /= matrix[k][k];
  }
  return right;
}

// The point of the half-spaces with the greatest last coordinate, by the dual simplex method.
// `basis` names four half-spaces whose common point is greatest among the points of these four.
std::array<double, 4> greatest(const std::vector<HalfSpace>& constraints,
                               std::array<std::size_t, 4> basis) {
  constexpr double kTolerance = 1e-15;
  constexpr int kMostPivots = 1000;  // some ten are usual
  std::array<double, 4> point{};
  for (int pivot = 0; pivot < kMostPivots; ++pivot) {
    std::array<std::array<double, 4>, 4> rows, columns;
    std::array<double, 4> bounds;
    for (std::size_t k = 0; k < 4; ++k) {
      rows[k] = constraints[basis[k]].row;
      bounds[k] = constraints[basis[k]].bound;
      for (std::size_t j = 0; j < 4; ++j) columns[j][k] = rows[k][j];
    }
    point = solve(rows, bounds);
    std::size_t entering = constraints.size();
    double worst = kTolerance;
    for (std::size_t i = 0; i < constraints.size(); ++i) {
      const double excess = product(constraints[i].row, point) - constraints[i].bound;
      if (excess > worst && std::ranges::count(basis, i) == 0) worst = excess, entering = i;
    }
    if (entering == constraints.size()) return point;
    const std::array<double, 4> weights = solve(columns, {0, 0, 0, 1}),
                                change = solve(columns, constraints[entering].row);
    std::size_t leaving = 4;
    double least = kNone;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(change[k] > kTolerance) || !(weights[k] / change[k] < least)) continue;
      least = weights[k] / change[k];
      leaving = k;
    }
    if (leaving == 4) return point;
    basis[leaving] = entering;
  }
  return point;
}

// The best step within a cube, and the clearance that it promises.
std::array<double, 4> best_step(const std::vector<Sphere>& balls, const Vec3d& place, double cube) {
  std::vector<HalfSpace> constraints;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      HalfSpace face{{0, 0, 0, 0}, cube};
      face.row[static_cast<std::size_t>(axis)] = side;
      constraints.push_back(face);
    }
  }
  std::size_t nearest = constraints.size();
  for (const Sphere& ball : balls) {
    const Vec3d from = place - ball.center;
    const double distance = norm(from);
    const Vec3d u = 1 / distance * from;
    constraints.push_back({{-u.x, -u.y, -u.z, 1}, distance - ball.radius});
    if (constraints.back().bound < constraints[nearest].bound) nearest = constraints.size() - 1;
  }
  std::array<std::size_t, 4> basis{nearest, 0, 2, 4};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (constraints[nearest].row[axis] < 0) ++basis[axis + 1];
  }
  return greatest(constraints, basis);
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
  constexpr double kCube = 0.02;
  constexpr double kConverged = 1e-14;
  constexpr int kMostSteps = 1000;
  double largest = 0;
  for (const Sphere& b : balls) largest = std::max(largest, b.radius);
  const double cube = kCube * largest;
  BallPool pool(balls, largest);
  ClearPlace at{start, clearance_at(balls, start)};
  for (int i = 0; i < kMostSteps; ++i) {
    if (trail) trail->push_back(at);
    if (at.clearance >= ceiling) return at;
    // No ball farther than this is nearer after the step than what is nearest now: both its
    // distance and the clearance change by at most the cube's half diagonal.
    const double reach = at.clearance + 2 * std::sqrt(3.0) * cube;
    const std::vector<Sphere> near = pool.within(at.place, reach);
    const std::array<double, 4> found = best_step(near, at.place, cube);
    const Vec3d step{found[0], found[1], found[2]};
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
