// Corners from the signs and cyclic orders of their coordinates; faces by trying all planes.
#include "reference/cages.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace vdwmesh::reference {
namespace {

using std::size_t;

constexpr double kInPlane = 1e-9;  // Å
constexpr double kPhi = std::numbers::phi;

// ± of every coordinate that is not 0.
std::vector<Point> with_signs(const Point& p) {
  std::vector<Point> all;
  for (int signs = 0; signs < 8; ++signs) {
    Point q = p;
    bool doubled = false;
    for (size_t k = 0; k < 3; ++k) {
      if ((signs >> k & 1) == 0) continue;
      doubled = doubled || q[k] == 0;
      q[k] = -q[k];
    }
    if (!doubled) all.push_back(q);
  }
  return all;
}

std::vector<Point> turned_with_signs(const Point& p) {
  std::vector<Point> all;
  for (size_t turn = 0; turn < 3; ++turn) {
    const std::vector<Point> some = with_signs({{p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]}});
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

std::vector<Point> scaled(std::vector<Point> points, double factor) {
  for (Point& p : points) p = factor * p;
  return points;
}

// The corners in the plane of three of them if all others are below it, in order around the face.
std::vector<size_t> face_through(const std::vector<Point>& corners, size_t a, size_t b, size_t c) {
  Point up = outer(corners[b] - corners[a], corners[c] - corners[a]);
  if (length(up) < kInPlane) return {};
  up = (1 / length(up)) * up;
  std::vector<size_t> face;
  Point middle{{0, 0, 0}};
  for (size_t k = 0; k < corners.size(); ++k) {
    const double height = inner(corners[k] - corners[a], up);
    if (height > kInPlane) return {};
    if (height < -kInPlane) continue;
    face.push_back(k);
    middle = middle + corners[k];
  }
  middle = (1.0 / static_cast<double>(face.size())) * middle;
  const Point east = corners[face[0]] - middle, north = outer(up, east);
  std::sort(face.begin(), face.end(), [&](size_t i, size_t j) {
    const auto angle = [&](size_t k) {
      return std::atan2(inner(corners[k] - middle, north), inner(corners[k] - middle, east));
    };
    return angle(i) < angle(j);
  });
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

}  // namespace

Cage hull_cage(const std::vector<Point>& corners) {
  std::set<std::vector<size_t>> faces;
  for (size_t a = 0; a < corners.size(); ++a) {
    for (size_t b = a + 1; b < corners.size(); ++b) {
      for (size_t c = b + 1; c < corners.size(); ++c) {
        faces.insert(face_through(corners, a, b, c));
        faces.insert(face_through(corners, a, c, b));
      }
    }
  }
  faces.erase(std::vector<size_t>{});
  return {corners, {faces.begin(), faces.end()}};
}

std::vector<Point> tetrahedron(double edge) {
  return scaled({{{1, 1, 1}}, {{1, -1, -1}}, {{-1, 1, -1}}, {{-1, -1, 1}}}, edge / std::sqrt(8.0));
}

std::vector<Point> octahedron(double edge) {
  return scaled(turned_with_signs({{1, 0, 0}}), edge / std::numbers::sqrt2);
}

std::vector<Point> cube(double edge) { return scaled(with_signs({{1, 1, 1}}), edge / 2); }

std::vector<Point> icosahedron(double edge) {
  return scaled(turned_with_signs({{0, 1, kPhi}}), edge / 2);
}

std::vector<Point> dodecahedron(double edge) {
  std::vector<Point> corners = with_signs({{1, 1, 1}});
  const std::vector<Point> others = turned_with_signs({{0, kPhi - 1, kPhi}});
  corners.insert(corners.end(), others.begin(), others.end());
  return scaled(corners, edge * kPhi / 2);
}

std::vector<Point> regular_polygon(int corners, double edge) {
  const double step = 2 * std::numbers::pi / corners, radius = edge / (2 * std::sin(step / 2));
  std::vector<Point> points;
  for (int k = 0; k < corners; ++k) {
    points.push_back({{radius * std::cos(k * step), radius * std::sin(k * step), 0}});
  }
  return points;
}

std::vector<Point> fullerene(double pentagon_bond, double hexagon_bond) {
  const double edge = 2 * pentagon_bond + hexagon_bond;
  const std::vector<Point> corners = icosahedron(edge);
  std::vector<Point> atoms;
  for (const Point& a : corners) {
    for (const Point& b : corners) {
      if (std::abs(distance(a, b) - edge) < kInPlane) {
        atoms.push_back(a + (pentagon_bond / edge) * (b - a));
      }
    }
  }
  return atoms;
}

}  // namespace vdwmesh::reference
