// angle_by_dihedrals(): the angle of an arc as a difference of dihedral angles.
//
// An arc of the circle of edge e starts at a corner of triangle f and ends at one of triangle g.
// Three angles about e enter:
// - the gap from f to g, on the side of the arc: a dihedral angle of the tetrahedron of the edge
//   and the third vertices of f and g, or 2 π minus it;
// - for f and for g, the angle between the triangle and the half-plane through e and the corner.
// The angle of the arc is the gap minus the other two.
#include "arrangement/complex/arc_angle.hpp"

#include <cmath>
#include <numbers>

#include "arrangement/complex/power_predicates.hpp"

namespace vdwmesh {
namespace {

// Returns k if edge e is opposite to vertex k of the triangle. Precondition: e is one of its edges.
std::size_t slot(const DualTriangle& f, std::uint32_t e) {
  return f.edges[0] == e ? 0 : (f.edges[1] == e ? 1 : 2);
}

// Angle about edge e between triangle f and the half-plane through e and a corner of f, the same
// for both corners.
double dihedral_at_corner(const PowerTriangulation& t, const DualTriangle& f, std::uint32_t e) {
  const auto& v = f.vertices;
  const std::array<const Sphere*, 3> balls{&t.balls[v[0]], &t.balls[v[1]], &t.balls[v[2]]};
  return corner_dihedral(balls, triangle_shape(*balls[0], *balls[1], *balls[2]), slot(f, e));
}

// Angle about edge e from triangle f counter-clockwise to triangle g, in radians. It is a whole
// turn if both are the same triangle. If it is below π, the edge and the third vertices c of f and
// d of g form a positively oriented tetrahedron with this dihedral angle at e. Otherwise the
// tetrahedron fills the rest of the turn.
double gap_angle(const PowerTriangulation& t, const DualComplex& complex, std::uint32_t e,
                 const DualTriangle& f, const DualTriangle& g) {
  if (&f == &g) return 2 * std::numbers::pi;
  const Sphere &a = t.balls[complex.edges[e].vertices[0]],
               &b = t.balls[complex.edges[e].vertices[1]], &c = t.balls[f.vertices[slot(f, e)]],
               &d = t.balls[g.vertices[slot(g, e)]];
  const bool convex = orientation_sign(a, b, c, d) == Sign::positive;
  const TetrahedronShape shape =
      convex ? tetrahedron_shape({a, b, c, d}) : tetrahedron_shape({a, b, d, c});
  return convex ? shape.dihedral[0] : 2 * std::numbers::pi - shape.dihedral[0];
}

}  // namespace

// `start / 2` and `end / 2` are the triangles of the two corners (see CornerIndex).
double angle_by_dihedrals(const PowerTriangulation& triangulation, const DualComplex& complex,
                          const ExposedArc& arc) {
  const DualTriangle &f = complex.triangles[arc.start / 2], &g = complex.triangles[arc.end / 2];
  return gap_angle(triangulation, complex, arc.edge, f, g) -
         dihedral_at_corner(triangulation, f, arc.edge) -
         dihedral_at_corner(triangulation, g, arc.edge);
}

}  // namespace vdwmesh
