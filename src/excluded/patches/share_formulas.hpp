// Formulas for the shares of atoms in a concave patch, and for the flat faces of caps.
//
// The area of a region on the unit sphere is the sum over its boundary of signed fans from a point
// z: fan(arc) is the area between the arc and the great circles from z to its ends.
#pragma once

#include <cmath>

#include "core/vec3.hpp"
#include "excluded/patches/bounded_list.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {

// The signed solid angle of a spherical triangle of unit vectors (Van Oosterom and Strackee 1983).
VDWMESH_HD inline double triangle_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  return 2 * std::atan2(triple_product(a, b, c), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// A directed circular arc on the unit sphere.
struct SphereArc {
  Vec3d axis;
  double cosine;  // of the circle's angular radius: axis · point
  Vec3d from;
  double angle;  // counter-clockwise about the axis; negative: clockwise

  VDWMESH_HD Vec3d at(double fraction) const {
    const Vec3d arm = from - cosine * axis;
    const double phi = fraction * angle;
    return cosine * axis + std::cos(phi) * arm + std::sin(phi) * cross(axis, arm);
  }
};

// The fan from z over an arc from p to q of at most one radian. It is the triangle z p q plus the
// area between the arc and its chord, which is the great circle from p to q. Seen from the circle's
// axis, that area is the fan over the arc, angle (1 - cosine), less the triangle axis p q.
VDWMESH_HD inline double short_fan(const Vec3d& z, const SphereArc& arc, const Vec3d& p,
                                   const Vec3d& q, double angle) {
  return triangle_angle(z, p, q) + angle * (1 - arc.cosine) - triangle_angle(arc.axis, p, q);
}

// The fan from z over the part of an arc between two fractions of it, in steps of at most one
// radian.
VDWMESH_HD inline double fan(const Vec3d& z, const SphereArc& arc, double begin, double end) {
  const double angle = (end - begin) * arc.angle, turned = std::abs(angle);
  const int steps = turned > 1 ? static_cast<int>(std::ceil(turned)) : 1;
  double sum = 0;
  Vec3d p = arc.at(begin);
  for (int i = 1; i <= steps; ++i) {
    const Vec3d q = arc.at(begin + (end - begin) * i / steps);
    sum += short_fan(z, arc, p, q, angle / steps);
    p = q;
  }
  return sum;
}

// Calls add(fraction) where the arc crosses the plane through the sphere's centre with this normal:
// twice at most.
template <class Add>
VDWMESH_HD void cross_plane(const SphereArc& arc, const Vec3d& normal, const Add& add) {
  constexpr double kTurn = 2 * 3.14159265358979323846;
  const Vec3d arm = arc.from - arc.cosine * arc.axis;
  const double x = dot(normal, arm), y = dot(normal, cross(arc.axis, arm));
  const double ratio = -arc.cosine * dot(normal, arc.axis) / std::hypot(x, y);
  if (!(std::abs(ratio) < 1)) return;
  for (int side = -1; side <= 1; side += 2) {
    double phi = std::atan2(y, x) + side * std::acos(ratio);
    if (arc.angle < 0) phi = -phi;
    phi = std::remainder(phi, kTurn);
    if (phi < 0) phi += kTurn;
    const double fraction = phi / std::abs(arc.angle);
    if (fraction < 1) add(fraction);
  }
}

// A point in the plane of a cap's flat face, from the middle of its disk.
struct FacePoint {
  double x, y;
};

VDWMESH_HD inline double inner(const FacePoint& a, const FacePoint& b) {
  return a.x * b.x + a.y * b.y;
}
VDWMESH_HD inline double outer(const FacePoint& a, const FacePoint& b) {
  return a.x * b.y - a.y * b.x;
}
VDWMESH_HD inline FacePoint between(const FacePoint& a, const FacePoint& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

// The signed area of a circular sector between two directions.
VDWMESH_HD inline double sector(const FacePoint& a, const FacePoint& b, double squared_radius) {
  return 0.5 * squared_radius * std::atan2(outer(a, b), inner(a, b));
}

// The signed area of disk ∩ the triangle of the origin, a and b.
VDWMESH_HD inline double triangle_in_disk(const FacePoint& a, const FacePoint& b,
                                          double squared_radius) {
  const FacePoint along{b.x - a.x, b.y - a.y};
  const double length2 = inner(along, along), start = inner(a, along);
  const double excess = inner(a, a) - squared_radius;
  const double root2 = start * start - length2 * excess;
  if (!(length2 > 0) || !(root2 > 0)) return sector(a, b, squared_radius);
  const double root = std::sqrt(root2);
  const double first = (-start - root) / length2, second = (-start + root) / length2;
  const double enter = first < 0 ? 0 : (first > 1 ? 1 : first);
  const double leave = second < 0 ? 0 : (second > 1 ? 1 : second);
  if (!(enter < leave)) return sector(a, b, squared_radius);
  const FacePoint p = enter > 0 ? between(a, b, enter) : a,
                  q = leave < 1 ? between(a, b, leave) : b;
  // A sector from a point to itself is nothing; at the origin its angle would be anything.
  const double before = enter > 0 ? sector(a, p, squared_radius) : 0;
  const double behind = leave < 1 ? sector(q, b, squared_radius) : 0;
  return before + 0.5 * outer(p, q) + behind;
}

// The flat face of a cap: the part of the cap's disk {axis · w = cosine, |w| <= 1} that lies in
// some half-spaces. A square around the disk is clipped by them, and polygon ∩ disk is measured.
// Both are in the plane of the disk, in coordinates from the disk's centre: a point is cosine ·
// axis + x first + y second, and the radius of the disk is the sine, at most 1.
//
// The area depends continuously on all planes, so it needs no decisions about which of them meet.
template <class Lists>
class CapFace {
 public:
  // `axis` is a unit vector.
  VDWMESH_HD CapFace(const Vec3d& axis, double cosine)
      : axis_(axis), first_(any_orthogonal(axis)), second_(cross(axis, first_)), cosine_(cosine) {
    FacePoints& square = points_[0];  // it holds any such disk
    square.push_back({-2, -2});
    square.push_back({2, -2});
    square.push_back({2, 2});
    square.push_back({-2, 2});
  }

  // Keeps the part with normal · w <= height. How many points there are is counted beside the
  // lists, in a register of a device.
  VDWMESH_HD void clip(const Vec3d& normal, double height) {
    if (size_ == 0) return;
    const FacePoint toward{dot(normal, first_), dot(normal, second_)};
    const double limit = height - cosine_ * dot(normal, axis_);
    const FacePoints& polygon = points_[now_];
    FacePoints& out = points_[1 - now_];
    out.resize(2 * size_);
    const std::size_t room = out.size();
    std::size_t kept = 0;
    const FacePoint start = polygon[0];
    FacePoint a = start;
    double over_a = inner(toward, a) - limit;
    for (std::size_t i = 0; i < size_; ++i) {
      const FacePoint b = i + 1 < size_ ? polygon[i + 1] : start;
      const double over_b = inner(toward, b) - limit;
      if (over_a <= 0 && kept < room) out[kept++] = a;
      if ((over_a <= 0) != (over_b <= 0) && kept < room) {
        out[kept++] = between(a, b, over_a / (over_a - over_b));
      }
      a = b;
      over_a = over_b;
    }
    now_ = 1 - now_;
    size_ = kept;
  }

  VDWMESH_HD bool is_empty() const { return size_ == 0; }
  VDWMESH_HD double area() const {
    const FacePoints& polygon = points_[now_];
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const std::size_t next = i + 1 < size_ ? i + 1 : 0;
      sum += triangle_in_disk(polygon[i], polygon[next], (1 - cosine_) * (1 + cosine_));
    }
    return sum;
  }

 private:
  static constexpr int kMostPoints = 48;
  using FacePoints = typename Lists::template List<FacePoint, kMostPoints>;

  Vec3d axis_, first_, second_;
  double cosine_;
  FacePoints points_[2];  // of the polygon, and memory for the next one
  int now_ = 0;           // which of them has the polygon
  std::size_t size_ = 4;  // points of the polygon
};

}  // namespace vdwmesh::excluded
