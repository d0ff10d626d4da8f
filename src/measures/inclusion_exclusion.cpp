// inclusion_exclusion(): areas and volumes from angles of tetrahedra, triangles and edges.
//
// The ball ∩ power cell of each ball is divided into cones from its centre: one over the exposed
// area and one over each power face. For a ball of radius r,
//   area   = r² (4 π - Ω) - sum over edges of φ r (r - h)
//   volume = r area / 3 + sum over edges of h F / 3
// Ω: solid angle at the centre that is taken by tetrahedra of the complex and by corner tetrahedra.
//    A corner tetrahedron spans the centres of a triangle and one of its exposed corners.
// φ: angle about the edge that these tetrahedra leave free. Over this angle the sphere loses part
//    of the cap in the other ball.
// h: signed height of the radical plane over the centre. F: area of power face ∩ ball.
//
// The shapes of simplices are computed on all cores; then what they add to is summed on one, in
// the order of the complex.
#include <cmath>
#include <limits>
#include <numbers>

#include "complex/simplex_shape.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "measures/measures.hpp"

namespace vdwmesh {
namespace {

// The sums are in more than double precision, because terms cancel: a ball may have thousands of
// neighbours and little exposed area.
struct BallSums {
  WideSum area, volume;
};

class ConeSums {
 public:
  ConeSums(const PowerTriangulation& triangulation, const DualComplex& complex)
      : t_(triangulation),
        k_(complex),
        taken_solid_angle_(t_.balls.size()),
        taken_dihedral_(k_.edges.size(), 0),
        face_area_(k_.edges.size(), 0),
        chord_(k_.triangles.size(), 0) {}

  // Of the edges, once run() has added up their triangles and tetrahedra.
  std::vector<EdgeCone> cones() const {
    std::vector<EdgeCone> cones(k_.edges.size());
    for_each_index(cones.size(), [&](std::size_t e) {
      const auto [a, b] = k_.edges[e].vertices;
      cones[e] = cone(e, edge_shape(ball(a), ball(b)));
    });
    return cones;
  }

  std::vector<SphereMeasures> run() {
    make_and_add(
        k_.tetrahedra.size(),
        [&](std::size_t i) {
          const auto& v = t_.cells[k_.tetrahedra[i]];
          return tetrahedron_shape({ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3])});
        },
        [&](std::size_t i, const TetrahedronShape& shape) {
          add_tetrahedron(k_.tetrahedra[i], shape);
        });
    make_and_add(
        k_.triangles.size(), [&](std::size_t f) { return shape_of(k_.triangles[f]); },
        [&](std::size_t f, const FacetShape& shape) {
          add_triangle(k_.triangles[f], chord_[f], shape);
        });
    std::vector<BallSums> sums(t_.balls.size());
    for (std::size_t v = 0; v < sums.size(); ++v) {
      const double r = t_.balls[v].radius;
      if (k_.exposed[v])
        sums[v].area.add(r * r * (4 * std::numbers::pi - taken_solid_angle_[v].value()));
    }
    make_and_add(
        k_.edges.size(),
        [&](std::size_t e) {
          return edge_shape(ball(k_.edges[e].vertices[0]), ball(k_.edges[e].vertices[1]));
        },
        [&](std::size_t e, const EdgeShape& shape) { add_edge(e, shape, sums); });
    std::vector<SphereMeasures> measures(t_.balls.size());
    for (std::size_t v = 0; v < measures.size(); ++v) {
      const double area = sums[v].area.value();
      sums[v].volume.add(area * t_.balls[v].radius / 3);
      measures[v] = {area, sums[v].volume.value()};
    }
    return measures;
  }

 private:
  // A triangle of the complex and the tetrahedron over it to an exposed corner, if there is one.
  struct FacetShape {
    TriangleShape triangle;
    CornerShape corner;
  };

  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }

  FacetShape shape_of(const DualTriangle& f) const {
    const Sphere &a = ball(f.vertices[0]), &b = ball(f.vertices[1]), &c = ball(f.vertices[2]);
    FacetShape shape{triangle_shape(a, b, c), {}};
    if (f.exposed[0] || f.exposed[1]) shape.corner = corner_shape(a, b, c, shape.triangle);
    return shape;
  }

  // Adds the tetrahedron's angles to its vertices and edges, and the heights of its orthogonal
  // centre over its facets to their chords. The number of edge ij of the complex is looked up in a
  // facet that has both vertices, that is, a facet opposite to another vertex.
  void add_tetrahedron(std::uint32_t c, const TetrahedronShape& shape) {
    const auto& v = t_.cells[c];
    const auto& facets = k_.cell_triangles[c];
    for (std::size_t k = 0; k < 4; ++k) {
      taken_solid_angle_[v[k]].add(shape.solid_angle[k]);
      chord_[facets[k]] += shape.center_height[k];
    }
    const DualTriangle &without0 = k_.triangles[facets[0]], &without3 = k_.triangles[facets[3]];
    taken_dihedral_[edge_between(without3, v[0], v[1])] += shape.dihedral[0];
    taken_dihedral_[edge_between(without3, v[0], v[2])] += shape.dihedral[1];
    taken_dihedral_[edge_between(k_.triangles[facets[2]], v[0], v[3])] += shape.dihedral[2];
    taken_dihedral_[edge_between(without3, v[1], v[2])] += shape.dihedral[3];
    taken_dihedral_[edge_between(without0, v[1], v[3])] += shape.dihedral[4];
    taken_dihedral_[edge_between(without0, v[2], v[3])] += shape.dihedral[5];
  }

  // `chord` is the length of the triangle's dual line (the points of equal power to its balls) from
  // its plane to the orthogonal centres of tetrahedra of the complex. On each exposed side the line
  // goes on to the corner instead. The power face of an edge is divided into triangles from the
  // circle's centre over such chords, and sectors.
  void add_triangle(const DualTriangle& f, double chord, const FacetShape& shape) {
    const int corners = f.exposed[0] + f.exposed[1];
    chord += corners * shape.triangle.half_chord;
    for (std::size_t k = 0; k < 3; ++k) {
      face_area_[f.edges[k]] += shape.triangle.distance[k] * chord / 2;
    }
    if (corners == 0) return;
    for (std::size_t k = 0; k < 3; ++k) {
      taken_solid_angle_[f.vertices[k]].add(corners * shape.corner.solid_angle[k]);
      taken_dihedral_[f.edges[k]] += corners * shape.corner.dihedral[k];
    }
  }

  // An edge that is not exposed has no free angle, exactly.
  EdgeCone cone(std::size_t e, const EdgeShape& shape) const {
    const double free_angle = k_.edges[e].exposed ? 2 * std::numbers::pi - taken_dihedral_[e] : 0.0;
    return {free_angle, face_area_[e] + shape.squared_circle_radius * free_angle / 2};
  }

  // Subtracts the pieces of caps over the edge's free angle from both areas, and adds the cones
  // from both centres over its power face.
  void add_edge(std::size_t e, const EdgeShape& shape, std::vector<BallSums>& sums) const {
    const DualEdge& edge = k_.edges[e];
    const auto [free_angle, face] = cone(e, shape);
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t v = edge.vertices[k];
      const double r = t_.balls[v].radius;
      if (k_.exposed[v]) sums[v].area.add(-free_angle * r * (r - shape.height[k]));
      sums[v].volume.add(shape.height[k] * face / 3);
    }
  }

  const PowerTriangulation& t_;
  const DualComplex& k_;
  std::vector<WideSum> taken_solid_angle_;  // per ball: Ω
  std::vector<double> taken_dihedral_;      // per edge: 2 π - φ
  std::vector<double> face_area_;           // per edge: F without circular sectors
  std::vector<double> chord_;               // per triangle: see add_triangle()
};

}  // namespace

std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex) {
  std::vector<SphereMeasures> measures = ConeSums(triangulation, complex).run();
  require_finite(measures);
  return measures;
}

std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex,
                                                std::vector<EdgeCone>& cones) {
  ConeSums sums(triangulation, complex);
  std::vector<SphereMeasures> measures = sums.run();
  require_finite(measures);
  cones = sums.cones();
  return measures;
}

std::vector<double> exposed_areas(const PowerTriangulation& triangulation,
                                  const DualComplex& complex) {
  std::vector<SphereMeasures> measures = ConeSums(triangulation, complex).run();
  std::vector<double> areas;
  areas.reserve(measures.size());
  for (std::size_t v = 0; v < measures.size(); ++v) {
    // A radius that is 0 once scaled, beside one that is not, has no area to speak of.
    const bool is_lost = complex.exposed[v] && triangulation.balls[v].radius == 0;
    measures[v].volume = is_lost ? std::numeric_limits<double>::infinity() : 0;
    areas.push_back(measures[v].area);
  }
  require_finite(measures);
  return areas;
}

void require_finite(const std::vector<SphereMeasures>& measures) {
  for (const SphereMeasures& m : measures) {
    if (std::isfinite(m.area) && std::isfinite(m.volume)) continue;
    throw InvalidInput(
        "the sizes of the spheres or the distances of their centres differ by too many powers of "
        "ten: areas and volumes are not finite in double precision");
  }
}

}  // namespace vdwmesh
