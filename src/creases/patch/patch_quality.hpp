// Quality criteria of a patch: when a triangle is bad, and when a piece of the boundary, a chord of
// an arc, is too long. Points are on the unit sphere, and lengths are straight distances between
// them. For host and device.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "spheres/directions.hpp"

namespace vdwmesh {

// A piece is too long if the patch beside it is narrow: if the height of the triangle on it is less
// than this fraction of the length of the piece.
inline constexpr double kLocalWidth = 0.3;
// A piece is too long if it is longer by more than this factor than a piece that meets it.
inline constexpr double kCornerRatio = 2;
// A triangle is bad if the sine of its least angle is below kBadAngleSine, or if its circumradius
// is above kLargeCircle times the wanted edge length. (An equilateral triangle has a circumradius
// of 0.58 of its edge length.)
inline constexpr double kBadAngleSine = 0.4;  // 23.6°
inline constexpr double kLargeCircle = 0.75;

// No angle of a triangle shall be smaller, but at corners of the patch that are less than twice as
// wide (angle_floors.hpp).
inline constexpr double kFloorOfAngles = 5;  // degrees
// The mesher enlarges angles up to this fraction more than their floor, since the mesh has other
// coordinates, with other rounding. Rounding by e turns an edge of length l by e / l, so this is
// enough for edges of more than some 1e8 times the rounding, 1e-6 Å at 100 Å from the origin. The
// sine is that of the floor with the fraction.
inline constexpr double kFloorMargin = 1e-7;
inline constexpr double kFloorSine = 0.0871557514410969;

// The cosine of the widest angle (110°) under which an inserted point may see a piece. A point that
// sees it under a wider angle would make a flat triangle with it. (Ruppert's algorithm has 90°
// here.)
inline constexpr double kWidestView = -0.35;

// The circumcentre of a triangle on the sphere, equally far from its three vertices, which are
// counter-clockwise seen from outside: the direction of the triangle's normal, and that of the
// circumcentre of the flat triangle. The normal of a tiny triangle is a bad answer: errors e of the
// vertices turn it by e over the size of the triangle, while they move the flat circumcentre by
// some e. The circumcentre of a large triangle is one: it lies near the sphere's centre.
VDWMESH_HD inline Vec3d circumcenter(const std::array<Vec3d, 3>& p) {
  const Vec3d a = p[1] - p[0], b = p[2] - p[0], normal = cross(a, b);
  const Vec3d towards = cross(squared_norm(a) * b - squared_norm(b) * a, normal);
  const Vec3d flat = p[0] + (1 / (2 * squared_norm(normal))) * towards;
  const bool is_small = squared_norm(flat) > 0.5 && dot(flat, normal) > 0;
  return unit(is_small ? flat : normal);
}

// Squared sine of the least angle of a triangle, by its squared edges x, y, z and the square of
// twice its area. The least angle is at most 60°, so comparing sines compares angles. It lies
// between the two longest edges, and its sine is twice the area divided by the product of their
// lengths.
VDWMESH_HD inline double least_squared_sine(double x, double y, double z,
                                            double squared_double_area) {
  // The longest of x and y, times the longer of the two others.
  const double two_longest = std::max(x, y) * std::max(std::min(x, y), z);
  return squared_double_area / two_longest;
}

// Whether a triangle with vertices p is bad: too large, or with too small an angle. constrained[k]
// says whether the edge opposite to vertex k is a piece of the boundary. A small angle between two
// pieces is given by the patch and does not make a triangle bad.
//
// With A the area, a, b, c the lengths of the edges and R the circumradius: R = a b c / (4 A). The
// least angle lies opposite to the shortest edge s, and its sine is s / (2 R). So with R, which is
// wanted anyway, it needs no least_squared_sine().
VDWMESH_HD inline bool is_bad(const std::array<Vec3d, 3>& p, const std::array<bool, 3>& constrained,
                              double edge_length, double bad_sine = kBadAngleSine) {
  const std::array<double, 3> edge{squared_norm(p[2] - p[1]), squared_norm(p[0] - p[2]),
                                   squared_norm(p[1] - p[0])};
  const double squared_area = squared_norm(cross(p[1] - p[0], p[2] - p[0]));  // (2A)²
  // Collinear vertices have no circumcircle. The triangle is left alone.
  if (!(squared_area > 0)) return false;
  const double squared_radius = edge[0] * edge[1] * edge[2] / (4 * squared_area);
  if (squared_radius > kLargeCircle * kLargeCircle * edge_length * edge_length) return true;
  // The index of the shortest edge, and of the vertex with the least angle. The other two edges
  // meet in that vertex.
  const auto s =
      static_cast<std::size_t>(std::min_element(edge.begin(), edge.end()) - edge.begin());
  const bool sharp_corner = constrained[(s + 2) % 3] && constrained[(s + 1) % 3] && !constrained[s];
  return edge[s] < 4 * bad_sine * bad_sine * squared_radius && !sharp_corner;
}

// Whether the piece from a to b is too long beside the one that joins its end `corner` and p.
VDWMESH_HD inline bool is_long_at_corner(const Vec3d& a, const Vec3d& b, const Vec3d& corner,
                                         const Vec3d& p) {
  const double squared_length = squared_norm(b - a), squared_beside = squared_norm(p - corner);
  // Surely not: the condition below, squared. Each has at most four roundings, so together they are
  // off by less than 10 · 2^-53 of either side. Most pieces end here, without a root.
  if (squared_length < 0.999 * kCornerRatio * kCornerRatio * squared_beside) return false;
  return std::sqrt(squared_length) > kCornerRatio * std::sqrt(squared_beside);
}

// How often the piece from a to b must be halved because the patch is narrow beside it; p is the
// apex of the triangle on the piece, inside the patch.
//
// The apex counts only if its foot on the line through a and b lies on the piece, or past an end of
// it by at most 0.2 of its length. If the height of the apex is less than kLocalWidth of the
// length, the piece is halved once; if it is less than half of that, twice. More is not asked for
// at once, because the next round of meshing looks at the halves again. Only pieces near the narrow
// part are split, so pieces may become longer along an arc with the distance from it.
VDWMESH_HD inline std::uint32_t halvings_for_width(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d ab = b - a, ap = p - a, normal = cross(ab, ap);
  const double squared_length = squared_norm(ab), squared_area = squared_norm(normal);
  // Surely not narrow: the condition below, squared. It has four roundings, and this one five, so
  // together they are off by less than 10 · 2^-53 of either side. Most pieces end here, without a
  // root or a quotient.
  if (squared_area > 1.001 * kLocalWidth * kLocalWidth * (squared_length * squared_length)) {
    return 0;
  }
  const double length = std::sqrt(squared_length);
  const double foot = dot(ap, ab) / squared_length;
  const double height = std::sqrt(squared_area) / length;
  if (!(foot > -0.2 && foot < 1.2 && height < kLocalWidth * length)) return 0;
  return height * 2 < kLocalWidth * length ? 2 : 1;
}

}  // namespace vdwmesh
