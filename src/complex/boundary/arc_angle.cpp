// angle_by_dihedrals(): the angle of an arc as a difference of dihedral angles.
//
// An arc of the circle of edge e starts at a corner of triangle f and ends at one of triangle g.
// Three angles about e enter:
// - the gap from f to g, on the side of the arc: a dihedral angle of the tetrahedron of the edge
//   and the third vertices of f and g, or 2 π minus it;
// - for f and for g, the angle between the triangle and the half-plane through e and the corner.
// The angle of the arc is the gap minus the other two.
#include "complex/boundary/arc_angle.hpp"

#include <cmath>
#include <numbers>

#include "complex/power_predicates.hpp"

namespace vdwmesh {
namespace {

using Balls = std::vector<Sphere>;
using Edge = std::array<std::uint32_t, 2>;
using Triangle3 = std::array<std::uint32_t, 3>;

// The place in the triangle of the vertex that is not on its edge.
std::size_t slot(const Triangle3& f, const Edge& e) {
  std::size_t k = 0;
  while (f[k] == e[0] || f[k] == e[1]) ++k;
  return k;
}

// Angle about the edge between triangle f and the half-plane through the edge and a corner of f,
// the same for both corners.
double dihedral_at_corner(const Balls& balls, const Triangle3& f, const Edge& e) {
  const std::array<const Sphere*, 3> of_f{&balls[f[0]], &balls[f[1]], &balls[f[2]]};
  return corner_dihedral(of_f, triangle_shape(*of_f[0], *of_f[1], *of_f[2]), slot(f, e));
}

// Angle about the edge from triangle f counter-clockwise to triangle g, in radians. It is a whole
// turn if both are the same triangle. If it is below π, the edge and the third vertices c of f and
// d of g form a positively oriented tetrahedron with this dihedral angle at the edge. Otherwise the
// tetrahedron fills the rest of the turn.
double gap_angle(const Balls& balls, const Edge& e, const Triangle3& f, const Triangle3& g) {
  const Sphere &a = balls[e[0]], &b = balls[e[1]], &c = balls[f[slot(f, e)]],
               &d = balls[g[slot(g, e)]];
  if (&c == &d) return 2 * std::numbers::pi;
  const bool convex = orientation_sign(a, b, c, d) == Sign::positive;
  const TetrahedronShape shape =
      convex ? tetrahedron_shape({a, b, c, d}) : tetrahedron_shape({a, b, d, c});
  return convex ? shape.dihedral[0] : 2 * std::numbers::pi - shape.dihedral[0];
}

}  // namespace

double angle_by_dihedrals(const Balls& balls, const Edge& edge, const Triangle3& start,
                          const Triangle3& end) {
  return gap_angle(balls, edge, start, end) - dihedral_at_corner(balls, start, edge) -
         dihedral_at_corner(balls, end, edge);
}

// `start / 2` and `end / 2` are the triangles of the two corners (see CornerIndex).
double angle_by_dihedrals(const PowerTriangulation& triangulation, const DualComplex& complex,
                          const ExposedArc& arc) {
  return angle_by_dihedrals(triangulation.balls, complex.edges[arc.edge].vertices,
                            complex.triangles[arc.start / 2].vertices,
                            complex.triangles[arc.end / 2].vertices);
}

}  // namespace vdwmesh
