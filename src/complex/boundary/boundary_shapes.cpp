// BoundaryShapes: circles, arcs and corners of the union's boundary.
//
// A circle is small on a sphere if its squared radius is below a fraction of the squared radius of
// the sphere. Its corners are then so near to its centre that the angles of arcs lose digits, and
// the cosines of turning angles lose twice as many, because they are differences.
#include "complex/boundary/boundary_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "complex/boundary/arc_angle.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {
namespace {

constexpr double kSmallOnSphere = 1e-3;

}  // namespace

BoundaryShapes::BoundaryShapes(const PowerTriangulation& triangulation, const DualComplex& complex)
    : t_(triangulation), k_(complex), edges_(k_.edges.size()), corners_(k_.triangles.size()) {
  for_each_index(edges_.size(), [&](std::size_t e) {
    edges_[e] = edge_shape(ball(k_.edges[e].vertices[0]), ball(k_.edges[e].vertices[1]));
  });
  for_each_index(corners_.size(), [&](std::size_t f) {
    const auto& v = k_.triangles[f].vertices;
    corners_[f] = common_points(ball(v[0]), ball(v[1]), ball(v[2]));
  });
}

// Whether the circle of edge e is small on a sphere of this radius, or the edge is so short that
// products of lengths may underflow.
bool BoundaryShapes::is_small(std::uint32_t e, double radius) const {
  return edges_[e].squared_circle_radius < kSmallOnSphere * radius * radius ||
         edges_[e].length < kShortEdge;
}

Vec3d BoundaryShapes::corner_from_circle(std::uint32_t e, CornerIndex corner) const {
  const CommonPoints& points = corners_[corner / 2];
  return from_circle(e, k_.triangles[corner / 2], corner % 2 == 0 ? points.above : points.below);
}

// The angle from the arc's start to its end, seen from the circle's centre. On small circles
// angle_by_dihedrals() computes it instead. For angles next to 0 or 2 π it says only which of the
// two it is.
double BoundaryShapes::angle(const ExposedArc& arc) const {
  if (arc.start == kNoCorner) return 2 * std::numbers::pi;
  const auto& [a, b] = k_.edges[arc.edge].vertices;
  if (is_small(arc.edge, std::max(ball(a).radius, ball(b).radius)))
    return angle_by_dihedrals(t_, k_, arc);
  const Vec3d p = corner_from_circle(arc.edge, arc.start),
              q = corner_from_circle(arc.edge, arc.end);
  const double angle =
      std::atan2(triple_product(between(a, b), p, q) / edges_[arc.edge].length, dot(p, q));
  if (std::abs(angle) < kSmallArc) {
    return angle_by_dihedrals(t_, k_, arc) > std::numbers::pi ? 2 * std::numbers::pi + angle
                                                              : angle;
  }
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

// The angle between two planes through the centre o of k and the corner x; one contains the centre
// p, the other q. With |x - o| = r: cosine ∝ r² op·oq - (op·ox)(oq·ox), sine ∝ r det(op, oq, ox).
double BoundaryShapes::turning_angle(std::size_t triangle, std::size_t k) const {
  const DualTriangle& f = k_.triangles[triangle];
  const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
  const double radius = ball(f.vertices[k]).radius;
  if (is_small(f.edges[m], radius) || is_small(f.edges[n], radius)) return angle_by_excess(f, k);
  const std::uint32_t o = f.vertices[k], p = f.vertices[m], q = f.vertices[n];
  const Vec3d op = between(o, p), oq = between(o, q);
  const double cosine = radius * radius * dot(op, oq) - reach(f.edges[n], o) * reach(f.edges[m], o);
  const double determinant = corners_[triangle].half_chord * corners_[triangle].twice_area;
  return std::atan2(radius * determinant, cosine);
}

// For vertex v of edge e and the other vertex w: the scalar product of the vectors from the centre
// of v to the centre of w and to a point x on the circle of e. It is the same for every x.
double BoundaryShapes::reach(std::uint32_t e, std::uint32_t v) const {
  return edges_[e].height[k_.edges[e].vertices[0] == v ? 0 : 1] * edges_[e].length;
}

// The turning angle from the spherical triangle that p, q and the corner span at o. Its area is the
// solid angle, its angles at p and q are dihedral angles. The sum of its three angles exceeds π by
// the area, so the third one is π + area - the other two.
double BoundaryShapes::angle_by_excess(const DualTriangle& f, std::size_t k) const {
  const Sphere &a = ball(f.vertices[0]), &b = ball(f.vertices[1]), &c = ball(f.vertices[2]);
  const CornerShape corner = corner_shape(a, b, c, triangle_shape(a, b, c));
  return std::numbers::pi + corner.solid_angle[k] - corner.dihedral[(k + 1) % 3] -
         corner.dihedral[(k + 2) % 3];
}

}  // namespace vdwmesh
