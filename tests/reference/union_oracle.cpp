// union_oracle(): exposed arcs by sorting, area and volume by line integrals along them.
#include "reference/union_oracle.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace vdwmesh::reference {
namespace {

using std::size_t;

// Doubles of like size differ by 1e-16 of it or not at all, and squares of them by 1e-32. Numbers
// below this are 0 but for the rounding of the hundredth digit.
const Digits kNothing("1e-50");

Digits pi() {
  static const Digits value = acos(Digits(-1));
  return value;
}

struct Vector {
  Digits x, y, z;
};
Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(const Digits& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
Digits dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector unit(const Vector& a) { return (1 / sqrt(dot(a, a))) * a; }

struct WideBall {
  Vector center;
  Digits radius;
};

// The cap of a sphere that another ball covers: u·axis >= cosine, for unit vectors u.
struct Cap {
  size_t ball;
  Vector axis, e1, e2;  // right-handed
  Digits cosine, sine;
};

Cap make_cap(const WideBall& sphere, const WideBall& other, size_t ball) {
  const Vector to = other.center - sphere.center;
  const Digits squared = dot(to, to), length = sqrt(squared);
  Cap cap;
  cap.ball = ball;
  cap.axis = (1 / length) * to;
  const Vector start = abs(cap.axis.x) < Digits(0.5) ? Vector{Digits(1), Digits(0), Digits(0)}
                                                     : Vector{Digits(0), Digits(1), Digits(0)};
  cap.e1 = unit(cross(cap.axis, start));
  cap.e2 = cross(cap.axis, cap.e1);
  cap.cosine = (squared + sphere.radius * sphere.radius - other.radius * other.radius) /
               (2 * length * sphere.radius);
  cap.sine = sqrt(std::max(Digits(0), Digits(1 - cap.cosine * cap.cosine)));
  return cap;
}

using Arc = std::pair<Digits, Digits>;  // angles on a circle, counter-clockwise about its axis

// Adds what `other` covers of the circle of `cap`: R cos(ψ - ψ0) >= C. Of two equal caps the first
// counts as the one that covers; complementary caps leave a boundary from both sides.
void add_covered(const Cap& cap, const Cap& other, std::vector<Arc>& covered) {
  const Digits x = cap.sine * dot(cap.e1, other.axis), y = cap.sine * dot(cap.e2, other.axis);
  const Digits along = dot(cap.axis, other.axis), c = other.cosine - cap.cosine * along;
  const Digits r = sqrt(x * x + y * y);
  const Digits turn = 2 * pi();
  if (r < kNothing) {
    const bool equal = abs(c) < kNothing && along > 0 && other.ball < cap.ball;
    if (c < -kNothing || equal) covered.emplace_back(Digits(0), turn);
    return;
  }
  if (c >= r) return;
  if (c <= -r) {
    covered.emplace_back(Digits(0), turn);
    return;
  }
  const Digits half = acos(Digits(c / r)), middle = atan2(y, x);
  Digits begin = middle - half, end = middle + half;
  if (begin < 0) {
    begin += turn;
    end += turn;
  }
  covered.emplace_back(begin, std::min(end, turn));
  if (end > turn) covered.emplace_back(Digits(0), Digits(end - turn));
}

// The parts of [0, 2 π] that no arc covers.
std::vector<Arc> gaps(std::vector<Arc> covered) {
  std::sort(covered.begin(), covered.end());
  std::vector<Arc> free;
  Digits reached = 0;
  for (const auto& [begin, end] : covered) {
    if (begin > reached) free.emplace_back(reached, begin);
    reached = std::max(reached, end);
  }
  if (reached < 2 * pi()) free.emplace_back(reached, Digits(2 * pi()));
  return free;
}

// The signed solid angle of the triangle of three unit vectors, by Van Oosterom and Strackee 1983.
Digits triangle(const Vector& a, const Vector& b, const Vector& c) {
  return 2 * atan2(dot(a, cross(b, c)), Digits(1 + dot(a, b) + dot(b, c) + dot(c, a)));
}

// Solid angle of the exposed part of a sphere, and the integral of the unit normal over it.
struct Exposed {
  Digits solid_angle = 0;
  Vector normal{Digits(0), Digits(0), Digits(0)};
};

// Subtracts an arc, whose exposed side is on its right. The fan between the arc and a fixed
// direction is a triangle, and the segment between the arc and its chord: a sector of the cap less
// a triangle. With u = cosine axis + sine ρ(ψ), the normal's integral is that of u × du / 2.
void subtract_arc(const Cap& cap, const Digits& begin, const Digits& end, Exposed& sum) {
  static const Vector kPole = unit({Digits(0.4142), Digits(-0.7320), Digits(0.5411)});
  const Vector ra = cos(begin) * cap.e1 + sin(begin) * cap.e2,
               rb = cos(end) * cap.e1 + sin(end) * cap.e2;
  const Vector a = cap.cosine * cap.axis + cap.sine * ra, b = cap.cosine * cap.axis + cap.sine * rb;
  const Digits angle = end - begin;
  sum.solid_angle -= triangle(kPole, a, b) + (1 - cap.cosine) * angle - triangle(cap.axis, a, b);
  const Vector integral_of_radius = cross(cap.axis, ra - rb);
  sum.normal = sum.normal - (cap.sine * cap.sine * angle / 2) * cap.axis +
               (cap.cosine * cap.sine / 2) * integral_of_radius;
}

class Oracle {
 public:
  explicit Oracle(const std::vector<Ball>& balls) {
    for (const Ball& b : balls) {
      balls_.push_back({{Digits(b.center[0]), Digits(b.center[1]), Digits(b.center[2])}, b.radius});
    }
  }

  WideMeasures run() const {
    WideMeasures out{0, 0};
    for (size_t i = 0; i < balls_.size(); ++i) {
      if (is_inside_other(i)) continue;
      const Exposed exposed = exposed_part(i);
      const WideBall& b = balls_[i];
      const Digits r2 = b.radius * b.radius, area = r2 * exposed.solid_angle;
      out.area += area;
      out.volume += (b.radius * area + r2 * dot(b.center, exposed.normal)) / 3;
    }
    return out;
  }

 private:
  // Of equal balls only the first is not inside another.
  bool is_inside_other(size_t i) const {
    for (size_t j = 0; j < balls_.size(); ++j) {
      const Vector to = balls_[j].center - balls_[i].center;
      const Digits more = balls_[j].radius - balls_[i].radius, squared = dot(to, to);
      if (j == i || more < 0 || squared > more * more) continue;
      if (squared > 0 || more > 0 || j < i) return true;
    }
    return false;
  }

  std::vector<Cap> caps_of(size_t i) const {
    std::vector<Cap> caps;
    for (size_t j = 0; j < balls_.size(); ++j) {
      const Vector to = balls_[j].center - balls_[i].center;
      const Digits squared = dot(to, to), reach = balls_[i].radius + balls_[j].radius,
                   less = balls_[i].radius - balls_[j].radius;
      if (j == i || squared >= reach * reach || squared <= less * less) continue;
      caps.push_back(make_cap(balls_[i], balls_[j], j));
    }
    return caps;
  }

  Exposed exposed_part(size_t i) const {
    const std::vector<Cap> caps = caps_of(i);
    Exposed sum;
    for (const Cap& cap : caps) {
      std::vector<Arc> covered;
      for (const Cap& other : caps) {
        if (other.ball != cap.ball) add_covered(cap, other, covered);
      }
      for (const auto& [begin, end] : gaps(std::move(covered))) {
        // In three parts, so that no triangle is a hemisphere.
        const Digits step = (end - begin) / 3;
        for (int k = 0; k < 3; ++k)
          subtract_arc(cap, begin + k * step, begin + (k + 1) * step, sum);
      }
    }
    settle_turns(caps, sum.solid_angle);
    return sum;
  }

  // The integral is known modulo 4 π. If it is all or nothing, a direction decides which: if the
  // sphere is exposed there, it is exposed but for a set without area.
  static void settle_turns(const std::vector<Cap>& caps, Digits& solid_angle) {
    const Digits whole = 4 * pi();
    solid_angle -= whole * floor(Digits(solid_angle / whole));
    if (solid_angle > kNothing && whole - solid_angle > kNothing) return;
    static const Vector kDirection = unit({Digits(0.2718), Digits(0.6180), Digits(-0.7307)});
    const bool covered = std::any_of(caps.begin(), caps.end(), [](const Cap& cap) {
      return dot(kDirection, cap.axis) >= cap.cosine;
    });
    solid_angle = covered ? Digits(0) : whole;
  }

  std::vector<WideBall> balls_;
};

}  // namespace

WideMeasures union_oracle(const std::vector<Ball>& balls) { return Oracle(balls).run(); }

}  // namespace vdwmesh::reference
