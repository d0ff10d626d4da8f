#include "arrangement/complex/arc_angle.hpp"

#include <cmath>
#include <numbers>

#include "arrangement/complex/power_predicates.hpp"

namespace vdwmesh {
namespace {

constexpr double kPi = std::numbers::pi;

std::size_t slot(const DualTriangle& f, std::uint32_t e) {
  return f.edges[0] == e ? 0 : (f.edges[1] == e ? 1 : 2);
}

double corner_dihedral(const PowerTriangulation& t, const DualTriangle& f, std::uint32_t e) {
  const TriangleShape shape =
      triangle_shape(t.balls[f.vertices[0]], t.balls[f.vertices[1]], t.balls[f.vertices[2]]);
  return std::atan2(shape.half_chord, shape.distance[slot(f, e)]);
}

double gap_angle(const PowerTriangulation& t, const DualComplex& complex, std::uint32_t e,
                 const DualTriangle& f, const DualTriangle& g) {
  if (&f == &g) return 2 * kPi;
  const Sphere &a = t.balls[complex.edges[e].vertices[0]],
               &b = t.balls[complex.edges[e].vertices[1]], &c = t.balls[f.vertices[slot(f, e)]],
               &d = t.balls[g.vertices[slot(g, e)]];
  const bool convex = orientation_sign(a, b, c, d) == Sign::positive;
  const TetrahedronShape shape =
      convex ? tetrahedron_shape({a, b, c, d}) : tetrahedron_shape({a, b, d, c});
  return convex ? shape.dihedral[0] : 2 * kPi - shape.dihedral[0];
}

}  // namespace

// The gap between the two triangles less what their corners take of it.
double angle_by_dihedrals(const PowerTriangulation& triangulation, const DualComplex& complex,
                          const ExposedArc& arc) {
  const DualTriangle &f = complex.triangles[arc.start / 2], &g = complex.triangles[arc.end / 2];
  return gap_angle(triangulation, complex, arc.edge, f, g) -
         corner_dihedral(triangulation, f, arc.edge) - corner_dihedral(triangulation, g, arc.edge);
}

}  // namespace vdwmesh
