// The intersection of triangles A and B is B clipped to the plane of A (three ways: the part above
// or on it, the part below or on it, both), and then to the three half-spaces through the edges of
// A. Clipping is that of I. E. Sutherland and G. W. Hodgman (Commun. ACM 17 (1974) 32); the result
// is a convex polygon, given by its corners, which may be a segment or a point.
#include "reference/crossing_pairs.hpp"

#include <algorithm>
#include <boost/multiprecision/gmp.hpp>

namespace vdwmesh::testing {
namespace {

using Rational = boost::multiprecision::number<boost::multiprecision::gmp_rational,
                                               boost::multiprecision::et_off>;
using Point = std::array<Rational, 3>;
using Corners = std::vector<Point>;

Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
bool is_zero(const Point& a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; }

// The part of the polygon in the half-space (x - origin) · normal >= 0.
Corners clipped(const Corners& polygon, const Point& origin, const Point& normal) {
  Corners result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Rational s = dot(minus(p, origin), normal), t = dot(minus(q, origin), normal);
    if (s >= 0) result.push_back(p);
    if ((s > 0 && t < 0) || (s < 0 && t > 0)) {
      const Rational part = s / (s - t);
      Point x;
      for (std::size_t k = 0; k < 3; ++k) x[k] = p[k] + part * (q[k] - p[k]);
      result.push_back(x);
    }
  }
  return result;
}

Corners intersection(const Corners& a, const Corners& b) {
  const Point normal = cross(minus(a[1], a[0]), minus(a[2], a[0]));
  Corners part = clipped(b, a[0], normal);
  part = clipped(part, a[0], {-normal[0], -normal[1], -normal[2]});
  for (std::size_t k = 0; k < 3; ++k) {
    part = clipped(part, a[k], cross(normal, minus(a[(k + 1) % 3], a[k])));
  }
  return part;
}

// Whether the points go beyond a point (one shared vertex) or a line (two).
bool goes_beyond(const Corners& points, const Corners& shared) {
  return std::any_of(points.begin(), points.end(), [&](const Point& p) {
    if (shared.empty()) return true;
    const Point d = minus(p, shared[0]);
    return shared.size() == 1 ? !is_zero(d) : !is_zero(cross(d, minus(shared[1], shared[0])));
  });
}

using Triangle = std::array<std::uint32_t, 3>;
using Positions = std::vector<std::array<double, 3>>;

Corners corners_of(const Positions& positions, const Triangle& t) {
  Corners corners;
  for (const std::uint32_t v : t) {
    const auto& p = positions[v];
    corners.push_back({Rational(p[0]), Rational(p[1]), Rational(p[2])});
  }
  return corners;
}

bool boxes_overlap(const Positions& positions, const Triangle& a, const Triangle& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto ends = [&](const Triangle& t) {
      return std::minmax({positions[t[0]][axis], positions[t[1]][axis], positions[t[2]][axis]});
    };
    const auto of_a = ends(a), of_b = ends(b);
    if (of_a.first > of_b.second || of_b.first > of_a.second) return false;
  }
  return true;
}

bool cross_each_other(const Positions& positions, const Triangle& a, const Triangle& b) {
  if (!boxes_overlap(positions, a, b)) return false;
  Corners shared;
  const Corners p = corners_of(positions, a), q = corners_of(positions, b);
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::find(b.begin(), b.end(), a[i]) != b.end()) shared.push_back(p[i]);
  }
  return shared.size() == 3 || goes_beyond(intersection(p, q), shared);
}

}  // namespace

std::vector<TrianglePair> crossing_pairs(const Positions& positions,
                                         const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> kept;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const Corners c = corners_of(positions, triangles[t]);
    if (!is_zero(cross(minus(c[1], c[0]), minus(c[2], c[0])))) kept.push_back(t);
  }
  std::vector<TrianglePair> pairs;
  for (std::size_t i = 0; i < kept.size(); ++i)
    for (std::size_t j = i + 1; j < kept.size(); ++j)
      if (cross_each_other(positions, triangles[kept[i]], triangles[kept[j]]))
        pairs.push_back({kept[i], kept[j]});
  return pairs;
}

}  // namespace vdwmesh::testing
