// gauss_bonnet(): areas by the Gauss–Bonnet theorem, volumes by pyramids over power faces.
//
// For a ball of radius r, with the Euler characteristic χ of its exposed patches, and for each of
// its radical planes the signed height h over the centre and the exposed angle φ of the circle in
// it:
//   area   = r² (2 π χ + sum φ h / r - sum turning angles)    turning angles at the corners
//   volume = r area / 3 + sum h F / 3,  F = area of (power face ∩ ball)
// F is a polygon in the radical plane, closed by circular sectors. It is summed as signed triangles
// from the centre of the circle: one over the chord of each triangle of the complex at the edge,
// and the sectors of the exposed arcs.
//
// The terms are computed on all cores, and then summed on one, in the order of the complex.
//
// These formulas lose digits if a circle is small (kSmallOnSphere). Its angles are then computed
// from solid and dihedral angles of simplex_shape.hpp.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/complex/arc_angle.hpp"
#include "arrangement/complex/exposed_arcs.hpp"
#include "arrangement/complex/measures.hpp"
#include "arrangement/complex/simplex_shape.hpp"
#include "arrangement/directions.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

// A circle on a sphere is small if its squared radius is below this fraction of the squared radius
// of the sphere. Its corners are so near to its centre that the angles of arcs lose digits. The
// cosines of turning angles lose twice as many, because they are differences.
constexpr double kSmallOnSphere = 1e-3;

// Adds 2 π n to more than double precision. 2 π is split into a double and the rest, because the
// rounding error of one double would count n times. The product is split into its rounded value and
// the rest too, which std::fma gives exactly.
void add_multiple_of_two_pi(int n, WideSum& sum) {
  constexpr double kTwoPi = 2 * std::numbers::pi,
                   kTwoPiRest = 2.4492935982947064e-16;  // 2 π - kTwoPi
  sum.add(kTwoPi * n);
  sum.add(std::fma(kTwoPi, n, -(kTwoPi * n)) + kTwoPiRest * n);
}

class GaussBonnetSum {
 public:
  GaussBonnetSum(const PowerTriangulation& triangulation, const DualComplex& complex)
      : t_(triangulation),
        k_(complex),
        euler_(t_.balls.size(), 2),
        curvature_(t_.balls.size()),
        twice_face_(k_.edges.size(), 0) {}

  std::vector<SphereMeasures> run() && {
    place_points();
    count_euler();
    edges_.resize(k_.edges.size());
    for_each_index(edges_.size(), [&](std::size_t e) {
      edges_[e] = edge_shape(ball(k_.edges[e].vertices[0]), ball(k_.edges[e].vertices[1]));
    });
    make_and_add(
        k_.triangles.size(), [&](std::size_t i) { return terms_of(i); },
        [&](std::size_t i, const TriangleTerms& terms) { add_triangle(i, terms); });
    const std::vector<ExposedArc> arcs = exposed_arcs(t_, k_);
    make_and_add(
        arcs.size(), [&](std::size_t i) { return exposed_angle(arcs[i]); },
        [&](std::size_t i, double angle) { add_arc(arcs[i], angle); });
    return sum();
  }

 private:
  // The part of a triangle's dual line (the line of equal power to its three balls) that lies in
  // the balls' common power face. Each end is a corner if that side is exposed, else the orthogonal
  // centre of the tetrahedron there. Positions are relative to the centre of the first ball.
  struct Chord {
    std::array<Vec3d, 2> end;  // on the side of cells[0], of cells[1]
    double determinant;  // >= 0, of two edge vectors of the triangle and the vector to the corner
                         // on the side of cells[0]: half_chord × twice_area
  };

  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }
  Vec3d between(std::uint32_t i, std::uint32_t j) const { return ball(j).center - ball(i).center; }

  // Finds the orthogonal centres of tetrahedra, then the chords of triangles.
  void place_points() {
    centers_.resize(t_.cells.size());
    for_each_index(k_.tetrahedra.size(), [&](std::size_t i) {
      const std::uint32_t c = k_.tetrahedra[i];
      const auto& v = t_.cells[c];
      centers_[c] = orthogonal_center({ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3])});
    });
    chords_.resize(k_.triangles.size());
    for_each_index(chords_.size(), [&](std::size_t f) { chords_[f] = chord(k_.triangles[f]); });
  }

  Chord chord(const DualTriangle& f) const {
    const CommonPoints points =
        common_points(ball(f.vertices[0]), ball(f.vertices[1]), ball(f.vertices[2]));
    Chord out{{points.above, points.below}, points.half_chord * points.twice_area};
    for (std::size_t s = 0; s < 2; ++s) {
      if (f.exposed[s]) continue;
      const std::uint32_t c = f.cells[s];
      out.end[s] = between(f.vertices[0], t_.cells[c][0]) + centers_[c];
    }
    return out;
  }

  // The exposed part of a sphere is homotopy equivalent to the complement of the vertex's link in a
  // sphere. So its Euler characteristic is 2, where euler_ starts, minus that of the link, whose
  // vertices, edges and triangles come from the edges, triangles and tetrahedra at the vertex.
  void count_euler() {
    for (const DualEdge& e : k_.edges) {
      for (const std::uint32_t v : e.vertices) --euler_[v];
    }
    for (const DualTriangle& f : k_.triangles) {
      for (const std::uint32_t v : f.vertices) ++euler_[v];
    }
    for (const std::uint32_t c : k_.tetrahedra) {
      for (const std::uint32_t v : t_.cells[c]) --euler_[v];
    }
  }

  // Whether the circle of edge e is small on a sphere of this radius, or the edge is so short that
  // products of lengths may underflow.
  bool is_small(std::uint32_t e, double radius) const {
    return edges_[e].squared_circle_radius < kSmallOnSphere * radius * radius ||
           edges_[e].length < kShortEdge;
  }

  // The vector from the centre of edge e's circle to `end`, which is relative to f's first ball.
  Vec3d from_circle(std::uint32_t e, const DualTriangle& f, const Vec3d& end) const {
    const auto& [a, b] = k_.edges[e].vertices;
    return between(a, f.vertices[0]) + end -
           (edges_[e].height[0] / edges_[e].length) * between(a, b);
  }

  // What a triangle adds to twice the area of the power face of each of its edges, and to the
  // curvature of each of its vertices.
  struct TriangleTerms {
    std::array<double, 3> twice_face, curvature;
  };

  // The terms of triangle i: for each of its edges the signed triangle from the circle's centre
  // over the chord to the power face, for each of its vertices the turning angles at its corners. A
  // chord runs counter-clockwise about the edge's axis, towards the triangle's leading side. Both
  // corners have the same angle by symmetry.
  TriangleTerms terms_of(std::size_t i) const {
    const DualTriangle& f = k_.triangles[i];
    TriangleTerms terms{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t e = f.edges[k];
      const std::size_t lead = leading_side(f, k);
      const auto& [a, b] = k_.edges[e].vertices;
      const Vec3d before = from_circle(e, f, chords_[i].end[1 - lead]),
                  after = from_circle(e, f, chords_[i].end[lead]);
      terms.twice_face[k] = triple_product(between(a, b), before, after) / edges_[e].length;
    }
    const int corners = f.exposed[0] + f.exposed[1];
    for (std::size_t k = 0; corners > 0 && k < 3; ++k) {
      terms.curvature[k] = -corners * turning_angle(f, k, chords_[i].determinant);
    }
    return terms;
  }

  void add_triangle(std::size_t i, const TriangleTerms& terms) {
    const DualTriangle& f = k_.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      twice_face_[f.edges[k]] += terms.twice_face[k];
      if (f.exposed[0] || f.exposed[1]) curvature_[f.vertices[k]].add(terms.curvature[k]);
    }
  }

  // The turning angle of the patch of vertex k at a corner of f. It is the angle between two planes
  // through the centre o of k and the corner x; one contains the centre p, the other q. With
  // |x - o| = r: cosine ∝ r² op·oq - (op·ox)(oq·ox), sine ∝ r det(op, oq, ox).
  double turning_angle(const DualTriangle& f, std::size_t k, double determinant) const {
    const std::size_t m = (k + 1) % 3, n = (k + 2) % 3;
    const double radius = ball(f.vertices[k]).radius;
    if (is_small(f.edges[m], radius) || is_small(f.edges[n], radius)) return angle_by_excess(f, k);
    const std::uint32_t o = f.vertices[k], p = f.vertices[m], q = f.vertices[n];
    const Vec3d op = between(o, p), oq = between(o, q);
    const double cosine =
        radius * radius * dot(op, oq) - reach(f.edges[n], o) * reach(f.edges[m], o);
    return std::atan2(radius * determinant, cosine);
  }

  // For vertex v of edge e and the other vertex w: the scalar product of the vectors from the
  // centre of v to the centre of w and to a point x on the circle of e. It is the same for every x.
  double reach(std::uint32_t e, std::uint32_t v) const {
    return edges_[e].height[k_.edges[e].vertices[0] == v ? 0 : 1] * edges_[e].length;
  }

  // The turning angle of turning_angle() from the spherical triangle that p, q and the corner span
  // at o. Its area is the solid angle, its angles at p and q are dihedral angles. The sum of its
  // three angles exceeds π by the area, so the third one is π + area - the other two.
  double angle_by_excess(const DualTriangle& f, std::size_t k) const {
    const Sphere &a = ball(f.vertices[0]), &b = ball(f.vertices[1]), &c = ball(f.vertices[2]);
    const CornerShape corner = corner_shape(a, b, c, triangle_shape(a, b, c));
    return std::numbers::pi + corner.solid_angle[k] - corner.dihedral[(k + 1) % 3] -
           corner.dihedral[(k + 2) % 3];
  }

  // The angle φ of an arc or of a whole circle.
  double exposed_angle(const ExposedArc& arc) const {
    return arc.start == kNoCorner ? 2 * std::numbers::pi : arc_angle(arc);
  }

  // Adds the arc's sector to the power face of its edge, and φ h / r to the sums of both spheres.
  void add_arc(const ExposedArc& arc, double angle) {
    const EdgeShape& shape = edges_[arc.edge];
    twice_face_[arc.edge] += shape.squared_circle_radius * angle;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t v = k_.edges[arc.edge].vertices[k];
      curvature_[v].add(angle * shape.height[k] / ball(v).radius);
    }
  }

  // The angle φ of an arc with corners, from 0 to 2 π: the angle from its start to its end, seen
  // from the circle's centre. On small circles angle_by_dihedrals() computes it instead. For angles
  // next to 0 or 2 π it says only which of the two it is.
  double arc_angle(const ExposedArc& arc) const {
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

  // The vector from the centre of edge e's circle to a corner (see CornerIndex).
  Vec3d corner_from_circle(std::uint32_t e, CornerIndex corner) const {
    return from_circle(e, k_.triangles[corner / 2], chords_[corner / 2].end[corner % 2]);
  }

  // Evaluates the formulas of the file's head. Balls that are not in the complex get 0.
  std::vector<SphereMeasures> sum() const {
    std::vector<WideSum> pyramids(t_.balls.size());
    for (std::size_t e = 0; e < k_.edges.size(); ++e) {
      for (std::size_t k = 0; k < 2; ++k) {
        pyramids[k_.edges[e].vertices[k]].add(edges_[e].height[k] * twice_face_[e] / 6);
      }
    }
    std::vector<SphereMeasures> out(t_.balls.size(), SphereMeasures{0, 0});
    for (std::size_t v = 0; v < out.size(); ++v) {
      if (!k_.in_complex[v]) continue;
      const double r = ball(static_cast<std::uint32_t>(v)).radius;
      // With n neighbours both terms are about n times as large as their sum, so both are kept in
      // more than double precision until they are added.
      WideSum curvature = curvature_[v];
      add_multiple_of_two_pi(euler_[v], curvature);
      out[v].area = r * r * curvature.value();
      pyramids[v].add(r * out[v].area / 3);
      out[v].volume = pyramids[v].value();
    }
    return out;
  }

  const PowerTriangulation& t_;
  const DualComplex& k_;
  std::vector<int> euler_;          // per ball: Euler characteristic of its exposed part
  std::vector<WideSum> curvature_;  // per ball: sum φ h / r less turning angles
  std::vector<double> twice_face_;  // per edge of the complex: twice the area of power face ∩ ball
  std::vector<EdgeShape> edges_;    // per edge of the complex
  Buffer<Vec3d> centers_;           // per cell: orthogonal centre from its first ball; set for
                                    // cells in the complex only
  std::vector<Chord> chords_;       // per triangle of the complex
};

}  // namespace

std::vector<SphereMeasures> gauss_bonnet(const PowerTriangulation& triangulation,
                                         const DualComplex& complex) {
  std::vector<SphereMeasures> measures = GaussBonnetSum(triangulation, complex).run();
  require_finite(measures);
  return measures;
}

}  // namespace vdwmesh
