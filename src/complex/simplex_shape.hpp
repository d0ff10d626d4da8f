// Lengths and angles of edges, triangles and tetrahedra of ball centres, and the points of equal
// power to their balls (orthogonal centres).
//
// Well-shaped simplices are computed in double. Thin triangles, flat tetrahedra and very short
// edges are computed in 100 decimal digits. Such simplices come from co-spherical, coplanar or
// collinear centres with jitter, and from centres so near that squares of distances underflow. No
// result depends on how flat or small a simplex is. The certificate has the same polynomials in
// intervals (certificate/simplex_terms.hpp), where no test of flatness is needed.
//
// Lengths are scaled as in the triangulation: the largest radius is in [1/2, 1).
#pragma once

#include <array>
#include <cstddef>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// If edges are shorter than this (scaled), products of several of their lengths may underflow.
inline constexpr double kShortEdge = 0x1p-100;

// An edge ab. The radical plane of a and b is at right angles to it and cuts both spheres in the
// same circle.
struct EdgeShape {
  double length;
  std::array<double, 2> height;  // signed distance of the plane from a and from b, positive on the
                                 // side of the other centre
  double squared_circle_radius;  // >= 0; 0 if the spheres do not quite meet
};
EdgeShape edge_shape(const Sphere& a, const Sphere& b);

// A triangle of three centres. Entry k belongs to vertex k or to the edge opposite to it.
struct TriangleShape {
  std::array<double, 3> distance;  // signed, in the plane: from the foot on the edge's line to the
                                   // orthogonal centre, positive towards vertex k
  double half_chord;               // from the plane to the points common to the three spheres, >= 0
  double twice_area;
};
TriangleShape triangle_shape(const Sphere& a, const Sphere& b, const Sphere& c);

// The angle at edge k of the triangle between it and the half-plane through the edge and a common
// point. Where the edge's balls touch from outside in the common point itself, the point is
// straight above the edge, as it is for balls that are a little larger.
double corner_dihedral(const std::array<const Sphere*, 3>& balls, const TriangleShape& triangle,
                       std::size_t k);

// The two points common to three spheres, relative to the centre of a. `above` is on the side of
// the plane of the centres from which a, b, c are counter-clockwise, `below` on the other. If the
// spheres do not quite meet, both are the orthogonal centre in the plane.
struct CommonPoints {
  Vec3d above, below;
  double half_chord, twice_area;  // half the points' distance; 2 × area of the centres' triangle
};
CommonPoints common_points(const Sphere& a, const Sphere& b, const Sphere& c);

// The squared radius of the smallest sphere that is orthogonal to three balls: minus the square of
// half the chord where the spheres meet, above 0 where they do not.
double orthogonal_size(const Sphere& a, const Sphere& b, const Sphere& c);

// The point of equal power to four balls, relative to the centre of the first.
Vec3d orthogonal_center(const std::array<Sphere, 4>& balls);

// A corner tetrahedron: the centres of a, b, c and a point common to the three spheres. Entry k has
// the solid angle at centre k and the dihedral angle at the triangle's edge opposite to it.
struct CornerShape {
  std::array<double, 3> solid_angle, dihedral;
  double volume;
};
CornerShape corner_shape(const Sphere& a, const Sphere& b, const Sphere& c,
                         const TriangleShape& triangle);

// A positively oriented tetrahedron of four centres. Dihedral angles are at the edges 01, 02, 03,
// 12, 13, 23.
struct TetrahedronShape {
  std::array<double, 6> dihedral;
  std::array<double, 4> solid_angle;
  std::array<double, 4> center_height;  // signed, of the orthogonal centre over the facet opposite
                                        // to vertex k, positive towards it
  double volume;
};
TetrahedronShape tetrahedron_shape(const std::array<Sphere, 4>& balls);

}  // namespace vdwmesh
