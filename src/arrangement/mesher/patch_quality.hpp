// When a triangle of a patch is bad, and when a piece of its boundary is too long. Points are on
// the unit sphere, and lengths are chords of it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "arrangement/directions.hpp"

namespace vdwmesh {

// A piece is too long for the patch beside it where a triangle on it is lower than this part of it.
inline constexpr double kLocalWidth = 0.3;
// Of two pieces at a corner, one may be this much longer than the other.
inline constexpr double kCornerRatio = 2;
// A triangle is bad below this angle, and above this circumradius by the edge length.
inline constexpr double kBadAngleSine = 0.4;  // 23.6°
inline constexpr double kLargeCircle = 0.75;

// The circle through the three vertices of a triangle.
struct FlatCircle {
  Vec3d center;  // on the sphere
  bool is_bad;
};

// `constrained` tells of each edge, opposite to vertex k, whether it is a piece of the boundary. An
// angle between two pieces is that of the patch and cannot be mended.
inline FlatCircle flat_circle(const std::array<Vec3d, 3>& p, const std::array<bool, 3>& constrained,
                              double edge_length) {
  const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
  const std::array<double, 3> edge{squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2]),
                                   squared_norm(p[1] - p[0])};
  const double squared_area = squared_norm(normal);  // (2A)²
  if (!(squared_area > 0)) return {p[0], false};
  const double squared_radius = edge[0] * edge[1] * edge[2] / (4 * squared_area);
  const auto s =
      static_cast<std::size_t>(std::min_element(edge.begin(), edge.end()) - edge.begin());
  const bool sharp_corner = constrained[(s + 2) % 3] && constrained[(s + 1) % 3] && !constrained[s];
  const bool is_large = squared_radius > kLargeCircle * kLargeCircle * edge_length * edge_length;
  const bool is_sharp =
      edge[s] < 4 * kBadAngleSine * kBadAngleSine * squared_radius && !sharp_corner;
  return {unit(normal), is_large || is_sharp};
}

// How often a piece from a to b is to be halved because the patch beside it, of which p is the next
// point, is narrow there: as often as the width asks for, but pieces may grow along the arc.
inline std::uint32_t halvings_for_width(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d ab = b - a, ap = p - a;
  const double squared_length = squared_norm(ab), length = std::sqrt(squared_length);
  const double foot = dot(ap, ab) / squared_length;
  const double height = norm(cross(ab, ap)) / length;
  if (!(foot > -0.2 && foot < 1.2 && height < kLocalWidth * length)) return 0;
  return height * 2 < kLocalWidth * length ? 2 : 1;
}

}  // namespace vdwmesh
