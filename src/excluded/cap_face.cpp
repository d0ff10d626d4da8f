// face_area(): clips a square around the disk by the half-spaces, and measures polygon ∩ disk.
//
// The area depends continuously on all planes, so it needs no decisions about which of them meet.
#include "excluded/cap_face.hpp"

#include <algorithm>
#include <cmath>

#include "arrangement/directions.hpp"

namespace vdwmesh::excluded {
namespace {

struct Point {
  double x, y;
};

double inner(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
double outer(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
Point between(const Point& a, const Point& b, double t) {
  return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

// The polygon's part with normal · point <= height.
std::vector<Point> clip(const std::vector<Point>& polygon, const Point& normal, double height) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double over_a = inner(normal, a) - height, over_b = inner(normal, b) - height;
    if (over_a <= 0) out.push_back(a);
    if ((over_a <= 0) != (over_b <= 0)) out.push_back(between(a, b, over_a / (over_a - over_b)));
  }
  return out;
}

// The signed area of a circular sector between two directions.
double sector(const Point& a, const Point& b, double squared_radius) {
  return 0.5 * squared_radius * std::atan2(outer(a, b), inner(a, b));
}

// The signed area of disk ∩ the triangle of the origin, a and b.
double triangle_in_disk(const Point& a, const Point& b, double squared_radius) {
  const Point along{b.x - a.x, b.y - a.y};
  const double length2 = inner(along, along), start = inner(a, along);
  const double excess = inner(a, a) - squared_radius;
  const double root2 = start * start - length2 * excess;
  if (!(length2 > 0) || !(root2 > 0)) return sector(a, b, squared_radius);
  const double root = std::sqrt(root2);
  const double enter = std::clamp((-start - root) / length2, 0.0, 1.0);
  const double leave = std::clamp((-start + root) / length2, 0.0, 1.0);
  if (!(enter < leave)) return sector(a, b, squared_radius);
  const Point p = enter > 0 ? between(a, b, enter) : a, q = leave < 1 ? between(a, b, leave) : b;
  // A sector from a point to itself is nothing; at the origin its angle would be anything.
  const double before = enter > 0 ? sector(a, p, squared_radius) : 0;
  const double behind = leave < 1 ? sector(q, b, squared_radius) : 0;
  return before + 0.5 * outer(p, q) + behind;
}

}  // namespace

double face_area(const Vec3d& axis, double cosine, std::span<const HalfSpace> within) {
  const Vec3d first = any_orthogonal(axis), second = cross(axis, first);
  std::vector<Point> polygon{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}};
  for (const HalfSpace& h : within) {
    polygon = clip(polygon, {dot(h.normal, first), dot(h.normal, second)},
                   h.height - cosine * dot(h.normal, axis));
  }
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    area += triangle_in_disk(polygon[i], polygon[(i + 1) % polygon.size()],
                             (1 - cosine) * (1 + cosine));
  }
  return area;
}

}  // namespace vdwmesh::excluded
