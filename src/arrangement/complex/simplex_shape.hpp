// Lengths and angles of triangles and tetrahedra of ball centres, with their orthogonal centres.
//
// In double where the simplex is well shaped, else (thin triangles, flat tetrahedra: co-spherical,
// coplanar and collinear input with jitter; centres so near that squares of their distance
// underflow) from 100 decimal digits, so that no result depends on how flat or small a simplex is.
//
// Lengths are scaled: the largest radius is between 1/2 and 1.
#pragma once

#include <array>

#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Products of several edges shorter than this (scaled) may underflow.
inline constexpr double kShortEdge = 0x1p-100;

// An edge ab: the radical plane cuts it at right angles, and both spheres in one circle.
struct EdgeShape {
  double length;
  std::array<double, 2> height;  // signed distance of the plane from each centre, towards the other
  double squared_circle_radius;  // >= 0
};
EdgeShape edge_shape(const Sphere& a, const Sphere& b);

// Entry k belongs to vertex k or to the edge opposite to it.
struct TriangleShape {
  std::array<double, 3> distance;  // signed, in the plane: from the foot on the edge's line to the
                                   // orthogonal centre, positive towards vertex k
  double half_chord;               // from the plane to the points common to the three spheres, >= 0
  double twice_area;
};
TriangleShape triangle_shape(const Sphere& a, const Sphere& b, const Sphere& c);

// The two points common to three spheres, from the centre of a: above the plane of the centres
// (which sees a, b, c counter-clockwise) and below it. Where the spheres do not quite meet, both
// are the orthogonal centre in the plane.
struct CommonPoints {
  Vec3d above, below;
  double half_chord, twice_area;  // between the points / 2; of the triangle of the centres
};
CommonPoints common_points(const Sphere& a, const Sphere& b, const Sphere& c);

// The point of equal power to four balls, from the centre of the first.
Vec3d orthogonal_center(const std::array<Sphere, 4>& balls);

// Solid angles at a, b, c and dihedral angles at the edges opposite to them, of the tetrahedron
// whose fourth vertex is a point common to the three spheres; its volume.
struct CornerShape {
  std::array<double, 3> solid_angle, dihedral;
  double volume;
};
CornerShape corner_shape(const Sphere& a, const Sphere& b, const Sphere& c,
                         const TriangleShape& triangle);

// Of a positively oriented tetrahedron. Pairs in the order 01 02 03 12 13 23.
struct TetrahedronShape {
  std::array<double, 6> dihedral;
  std::array<double, 4> solid_angle;
  std::array<double, 4> center_height;  // signed, of the orthogonal centre over the facet opposite
                                        // to vertex k, positive towards it
  double volume;
};
TetrahedronShape tetrahedron_shape(const std::array<Sphere, 4>& balls);

}  // namespace vdwmesh
