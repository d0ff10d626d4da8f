// Quality criteria of a patch: when a triangle is bad, and when a piece of the boundary is too
// long. Points are on the unit sphere, and lengths are straight distances between them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "arrangement/directions.hpp"

namespace vdwmesh {

// A piece is too long if the patch beside it is narrow: if the triangle on it is lower than this
// fraction of its length.
inline constexpr double kLocalWidth = 0.3;
// A piece is too long if a piece that meets it at a corner is shorter by more than this factor.
inline constexpr double kCornerRatio = 2;
// A triangle is bad if its least angle is below this bound, or if its circumradius is above this
// fraction of the edge length. (An equilateral triangle of that edge length has a circumradius of
// 0.58 of it.)
inline constexpr double kBadAngleSine = 0.4;  // 23.6°
inline constexpr double kLargeCircle = 0.75;

// The circumcircle of a triangle and the verdict on the triangle.
struct FlatCircle {
  Vec3d center;  // on the sphere, equally far from the three vertices
  bool is_bad;   // too large, or with too small an angle
};

// Judges a triangle with vertices p, counter-clockwise seen from outside. constrained[k] says
// whether the edge opposite to vertex k is a piece of the boundary. A small angle between two
// pieces is given by the patch and does not make a triangle bad.
//
// With A the area, a b c the edges and R the circumradius: R = a b c / (4 A), and the least angle
// lies opposite to the shortest edge, with sine edge / (2 R). The circumcentre on the sphere is the
// direction of the triangle's normal.
inline FlatCircle flat_circle(const std::array<Vec3d, 3>& p, const std::array<bool, 3>& constrained,
                              double edge_length) {
  const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
  const std::array<double, 3> edge{squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2]),
                                   squared_norm(p[1] - p[0])};
  const double squared_area = squared_norm(normal);  // (2A)²
  // Collinear vertices have no circumcircle. The triangle is left alone.
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

// How often the piece from a to b must be halved because the patch is narrow beside it; p is the
// apex of the triangle on the piece, inside the patch.
//
// The apex counts only if its foot on the line through a and b lies on the piece or at most 0.2 of
// its length past an end. If the height of the apex is less than kLocalWidth of the length, the
// piece is halved; if it is less than half of that, twice. No more is asked for at once, because
// the next round looks at the halves again. Only pieces near the narrow place are split, so pieces
// may grow along an arc.
inline std::uint32_t halvings_for_width(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d ab = b - a, ap = p - a;
  const double squared_length = squared_norm(ab), length = std::sqrt(squared_length);
  const double foot = dot(ap, ab) / squared_length;
  const double height = norm(cross(ab, ap)) / length;
  if (!(foot > -0.2 && foot < 1.2 && height < kLocalWidth * length)) return 0;
  return height * 2 < kLocalWidth * length ? 2 : 1;
}

}  // namespace vdwmesh
