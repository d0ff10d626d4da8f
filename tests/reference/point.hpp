// Points and triangle meshes of the reference code; nothing here comes from src/.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace vdwmesh::reference {

struct Point {
  std::array<double, 3> at;  // Å
  double& operator[](std::size_t axis) { return at[axis]; }
  const double& operator[](std::size_t axis) const { return at[axis]; }
};

inline Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Point operator-(const Point& a, const Point& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Point operator*(double s, const Point& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double inner(const Point& a, const Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Point& a) { return std::sqrt(inner(a, a)); }
inline double distance(const Point& a, const Point& b) { return length(a - b); }
inline Point outer(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Ball {
  Point center;
  double radius;
};

using Corners = std::array<std::uint32_t, 3>;

struct TriangleMesh {
  std::vector<Point> points;
  std::vector<Corners> triangles;  // counter-clockwise seen from outside
};

}  // namespace vdwmesh::reference
