// What a crease-exact mesh owes to its spheres, checked triangle by triangle from the definitions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reference/mesh_checks.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

struct CreaseSurvey {
  reference::MeshFacts facts;     // manifold, degenerate triangles, shells, by the reference code
  std::uint64_t bad_numbers = 0;  // positions or normals that are not finite or not unit
  std::uint64_t inward = 0;       // triangles that face their own sphere's centre, or its plane
  std::uint64_t bad_labels = 0;   // not one to three ids of the set, ascending, rest kNoSphere
  // Vertices whose label is not the set of the spheres of their triangles, and those with
  // triangles of more than three spheres, whose label cannot be it.
  std::uint64_t strange_labels = 0, crowded_vertices = 0;
  // Edges between triangles of two spheres of which an end is not labelled with both; crowded
  // vertices aside.
  std::uint64_t bad_arc_edges = 0;
  // Å: the farthest that a vertex is from a sphere of its label or of a triangle around it, and the
  // deepest that one is in a ball.
  double off_sphere = 0, depth = 0;

  bool sound() const;  // everything that needs no tolerance
  std::string text() const;
};

// Precondition: triangle_spheres and vertex_spheres are filled.
CreaseSurvey survey_creases(const SphereSet& spheres, const IndexedMesh& mesh);

// Angles of the triangles against those of the patches they fill. An angle at a corner of its patch
// has the floor of half the exact angle between the two arcs there, where that is less than
// kAngleFloor; all others have kAngleFloor.
inline constexpr double kAngleFloor = 5;  // degrees
struct AngleCensus {
  double median = 0, smallest = 0;    // degrees, of the least angle of each triangle
  double below_15 = 0;                // share of the triangles
  std::uint64_t below_5_degrees = 0;  // angles under kAngleFloor
  std::uint64_t unexplained = 0;      // those under their own floor
  double worst = 1;                   // the least ratio of an angle to its floor
  double sharpest_corner = 360;       // degrees, exact
  std::string text() const;
};
AngleCensus angle_census(const SphereSet& spheres, const IndexedMesh& mesh);

// The exact angle, degrees, of a patch of `sphere` at point p of it, whose boundary leaves p
// along the circle with sphere `right` towards `start` and, counter-clockwise seen from outside,
// along that with `left` towards `end`.
double patch_corner_angle(const Sphere& sphere, const Vec3d& p, const Sphere& right,
                          const Vec3d& start, const Sphere& left, const Vec3d& end);

// Pieces of the union of the open balls: balls that only touch are apart. Quadratic time.
std::uint64_t open_components(const SphereSet& spheres);

}  // namespace vdwmesh::testing
