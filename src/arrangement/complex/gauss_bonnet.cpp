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
#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/complex/boundary_shapes.hpp"
#include "arrangement/complex/measures.hpp"
#include "arrangement/directions.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

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
        shapes_(triangulation, complex),
        euler_(t_.balls.size(), 2),
        curvature_(t_.balls.size()),
        twice_face_(k_.edges.size(), 0) {}

  std::vector<SphereMeasures> run() && {
    place_points();
    count_euler();
    make_and_add(
        k_.triangles.size(), [&](std::size_t i) { return terms_of(i); },
        [&](std::size_t i, const TriangleTerms& terms) { add_triangle(i, terms); });
    const std::vector<ExposedArc> arcs = exposed_arcs(t_, k_);
    make_and_add(
        arcs.size(), [&](std::size_t i) { return shapes_.angle(arcs[i]); },
        [&](std::size_t i, double angle) { add_arc(arcs[i], angle); });
    return sum();
  }

 private:
  // The part of a triangle's dual line (the line of equal power to its three balls) that lies in
  // the balls' common power face. Each end is a corner if that side is exposed, else the orthogonal
  // centre of the tetrahedron there. Positions are relative to the centre of the first ball.
  struct Chord {
    std::array<Vec3d, 2> end;  // on the side of cells[0], of cells[1]
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
    for_each_index(chords_.size(), [&](std::size_t f) { chords_[f] = chord(f); });
  }

  Chord chord(std::size_t i) const {
    const DualTriangle& f = k_.triangles[i];
    const CommonPoints& points = shapes_.corners(i);
    Chord out{{points.above, points.below}};
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
      const Vec3d before = shapes_.from_circle(e, f, chords_[i].end[1 - lead]),
                  after = shapes_.from_circle(e, f, chords_[i].end[lead]);
      terms.twice_face[k] = triple_product(between(a, b), before, after) / shapes_.edge(e).length;
    }
    const int corners = f.exposed[0] + f.exposed[1];
    for (std::size_t k = 0; corners > 0 && k < 3; ++k) {
      terms.curvature[k] = -corners * shapes_.turning_angle(i, k);
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

  // Adds the arc's sector to the power face of its edge, and φ h / r to the sums of both spheres.
  void add_arc(const ExposedArc& arc, double angle) {
    const EdgeShape& shape = shapes_.edge(arc.edge);
    twice_face_[arc.edge] += shape.squared_circle_radius * angle;
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t v = k_.edges[arc.edge].vertices[k];
      curvature_[v].add(angle * shape.height[k] / ball(v).radius);
    }
  }

  // Evaluates the formulas of the file's head. Balls that are not in the complex get 0.
  std::vector<SphereMeasures> sum() const {
    std::vector<WideSum> pyramids(t_.balls.size());
    for (std::uint32_t e = 0; e < k_.edges.size(); ++e) {
      for (std::size_t k = 0; k < 2; ++k) {
        pyramids[k_.edges[e].vertices[k]].add(shapes_.edge(e).height[k] * twice_face_[e] / 6);
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
  const BoundaryShapes shapes_;
  std::vector<int> euler_;          // per ball: Euler characteristic of its exposed part
  std::vector<WideSum> curvature_;  // per ball: sum φ h / r less turning angles
  std::vector<double> twice_face_;  // per edge of the complex: twice the area of power face ∩ ball
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
