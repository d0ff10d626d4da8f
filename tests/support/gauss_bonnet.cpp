// by_gauss_bonnet(): areas by the Gauss–Bonnet theorem, volumes by pyramids over power faces.
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
// Areas are summed ball by ball on all cores, over its triangles and then its arcs, in the order of
// the complex. The terms of the volumes are computed on all cores, and then summed on one, in the
// same order.
#include "support/gauss_bonnet.hpp"

#include <atomic>
#include <cmath>
#include <numbers>

#include "complex/boundary/boundary_shapes.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/sorted_rows.hpp"
#include "core/sum.hpp"
#include "measures/reference_measures.hpp"
#include "measures/total_measures.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::testing {
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

// The angle of every arc.
Buffer<double> arc_angles(const BoundaryShapes& shapes, const std::vector<ExposedArc>& arcs) {
  Buffer<double> angles(arcs.size());
  for_each_index(arcs.size(), [&](std::size_t i) { angles[i] = shapes.angle(arcs[i]); });
  return angles;
}

// The exposed area of every ball.
class AreaSum {
 public:
  AreaSum(const PowerTriangulation& triangulation, const DualComplex& complex,
          const BoundaryShapes& shapes, const std::vector<ExposedArc>& arcs,
          const Buffer<double>& angles)
      : t_(triangulation),
        k_(complex),
        shapes_(shapes),
        arcs_(arcs),
        angles_(angles),
        euler_(t_.balls.size(), 2) {}

  std::vector<double> run() && {
    count_euler();
    triangles_.fill(t_.balls.size(), k_.triangles.size(), [&](std::size_t i, const auto& add) {
      const DualTriangle& f = k_.triangles[i];
      if (!f.exposed[0] && !f.exposed[1]) return;
      for (const std::uint32_t v : f.vertices) add(v, static_cast<std::uint32_t>(i));
    });
    arcs_of_.fill(t_.balls.size(), arcs_.size(), [&](std::size_t i, const auto& add) {
      for (const std::uint32_t v : k_.edges[arcs_[i].edge].vertices) {
        add(v, static_cast<std::uint32_t>(i));
      }
    });
    std::vector<double> areas(t_.balls.size());
    for_each_index(areas.size(),
                   [&](std::size_t v) { areas[v] = area(static_cast<std::uint32_t>(v)); });
    return areas;
  }

 private:
  // The exposed part of a sphere is homotopy equivalent to the complement of the vertex's link in a
  // sphere. So its Euler characteristic is 2, where euler_ starts, minus that of the link, whose
  // vertices, edges and triangles come from the edges, triangles and tetrahedra at the vertex.
  void count_euler() {
    const auto add = [&](std::uint32_t v, int n) {
      std::atomic_ref(euler_[v]).fetch_add(n, std::memory_order_relaxed);
    };
    for_each_index(k_.edges.size(), [&](std::size_t e) {
      for (const std::uint32_t v : k_.edges[e].vertices) add(v, -1);
    });
    for_each_index(k_.triangles.size(), [&](std::size_t f) {
      for (const std::uint32_t v : k_.triangles[f].vertices) add(v, 1);
    });
    for_each_index(k_.tetrahedra.size(), [&](std::size_t i) {
      for (const std::uint32_t v : t_.cells[k_.tetrahedra[i]]) add(v, -1);
    });
  }

  // r² (2 π χ + sum φ h / r - sum turning angles). Both corners of a triangle have the same turning
  // angles by symmetry. With n neighbours the sums are about n times as large as the result, so
  // they are kept in more than double precision. A ball that is not in the complex has none.
  double area(std::uint32_t v) const {
    if (!k_.in_complex[v]) return 0;
    const double r = t_.balls[v].radius;
    WideSum curvature;
    for (const std::uint32_t i : triangles_[v]) {
      const DualTriangle& f = k_.triangles[i];
      const std::size_t k = f.vertices[0] == v ? 0 : f.vertices[1] == v ? 1 : 2;
      curvature.add(-(f.exposed[0] + f.exposed[1]) * shapes_.turning_angle(i, k));
    }
    for (const std::uint32_t i : arcs_of_[v]) {
      const std::uint32_t e = arcs_[i].edge;
      const double height = shapes_.edge(e).height[k_.edges[e].vertices[0] == v ? 0 : 1];
      curvature.add(angles_[i] * height / r);
    }
    add_multiple_of_two_pi(euler_[v], curvature);
    return r * r * curvature.value();
  }

  const PowerTriangulation& t_;
  const DualComplex& k_;
  const BoundaryShapes& shapes_;
  const std::vector<ExposedArc>& arcs_;
  const Buffer<double>& angles_;                   // per arc
  std::vector<int> euler_;                         // per ball: χ of its exposed part
  SortedRows<std::uint32_t> triangles_, arcs_of_;  // per ball: its exposed triangles, its arcs
};

class GaussBonnetSum {
 public:
  GaussBonnetSum(const PowerTriangulation& triangulation, const DualComplex& complex)
      : t_(triangulation),
        k_(complex),
        shapes_(triangulation, complex),
        twice_face_(k_.edges.size(), 0) {}

  std::vector<SphereMeasures> run() && {
    place_points();
    make_and_add(
        k_.triangles.size(), [&](std::size_t i) { return faces_of(i); },
        [&](std::size_t i, const std::array<double, 3>& faces) {
          for (std::size_t k = 0; k < 3; ++k) twice_face_[k_.triangles[i].edges[k]] += faces[k];
        });
    const std::vector<ExposedArc> arcs = exposed_arcs(t_, k_);
    const Buffer<double> angles = arc_angles(shapes_, arcs);
    // Each arc adds its sector to the power face of its edge.
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      twice_face_[arcs[i].edge] += shapes_.edge(arcs[i].edge).squared_circle_radius * angles[i];
    }
    return sum(AreaSum(t_, k_, shapes_, arcs, angles).run());
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

  // What triangle i adds to twice the area of the power face of each of its edges: the signed
  // triangle from the circle's centre over the chord to the power face. A chord runs
  // counter-clockwise about the edge's axis, towards the triangle's leading side.
  std::array<double, 3> faces_of(std::size_t i) const {
    const DualTriangle& f = k_.triangles[i];
    std::array<double, 3> faces{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t e = f.edges[k];
      const std::size_t lead = leading_side(f, k);
      const auto& [a, b] = k_.edges[e].vertices;
      const Vec3d before = shapes_.from_circle(e, f, chords_[i].end[1 - lead]),
                  after = shapes_.from_circle(e, f, chords_[i].end[lead]);
      faces[k] = triple_product(between(a, b), before, after) / shapes_.edge(e).length;
    }
    return faces;
  }

  // Evaluates the formula of the file's head for the volumes. Balls that are not in the complex get
  // 0. The pyramids of n neighbours are kept in more than double precision, as in AreaSum.
  std::vector<SphereMeasures> sum(const std::vector<double>& areas) const {
    std::vector<WideSum> pyramids(t_.balls.size());
    for (std::uint32_t e = 0; e < k_.edges.size(); ++e) {
      for (std::size_t k = 0; k < 2; ++k) {
        pyramids[k_.edges[e].vertices[k]].add(shapes_.edge(e).height[k] * twice_face_[e] / 6);
      }
    }
    std::vector<SphereMeasures> out(t_.balls.size(), SphereMeasures{0, 0});
    for (std::size_t v = 0; v < out.size(); ++v) {
      if (!k_.in_complex[v]) continue;
      pyramids[v].add(ball(static_cast<std::uint32_t>(v)).radius * areas[v] / 3);
      out[v] = {areas[v], pyramids[v].value()};
    }
    return out;
  }

  const PowerTriangulation& t_;
  const DualComplex& k_;
  const BoundaryShapes shapes_;
  std::vector<double> twice_face_;  // per edge of the complex: twice the area of power face ∩ ball
  Buffer<Vec3d> centers_;           // per cell: orthogonal centre from its first ball; set for
                                    // cells in the complex only
  std::vector<Chord> chords_;       // per triangle of the complex
};

}  // namespace

SphereMeasures by_gauss_bonnet(const SphereSet& spheres) {
  const PowerTriangulation triangulation = triangulate(spheres);
  return total_measures(in_order_of(
      spheres, triangulation, GaussBonnetSum(triangulation, dual_complex(triangulation)).run()));
}

}  // namespace vdwmesh::testing
