// castp_sums(). With ω the solid angle at a vertex v, δ the dihedral angle at an edge e, and V_f
// the volume common to the balls of face f,
//   volume = tetrahedron - Σ_v ω R³ / 3 + Σ_e δ / 2π × lens - Σ_f V_f / 2
// and the area likewise, with whole spheres, caps, and the boundaries of V_f. Half of V_f is what
// the same sum says of the corner tetrahedron over f, which the balls of f cover: the corner's
// angles are taken from ω and δ, and its volume from the tetrahedron.
#include "pockets/castp_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "complex/simplex_shape.hpp"

namespace vdwmesh {
namespace {

// What two balls have in common, and its section with a plane through their centres.
struct LensParts {
  double volume, area;  // area: of both caps
  double section, arc;  // area and length of the boundary of half the section
};

// The cap of a ball beyond a plane at signed height h over its centre.
void add_cap(LensParts& lens, double radius, double h, double circle) {
  const double top = radius - h;
  lens.volume += std::numbers::pi * top * top * (3 * radius - top) / 3;
  lens.area += 2 * std::numbers::pi * radius * top;
  const double angle = std::atan2(circle, h);
  lens.section += (angle * radius * radius - h * circle) / 2;
  lens.arc += angle * radius;
}

class CastpFinder {
 public:
  CastpFinder(const PowerTriangulation& t, const DualComplex& complex, std::uint32_t cell)
      : t_(t), complex_(complex), cell_(cell), v_(t.cells[cell]) {}

  CastpSums run() && {
    shape_ = tetrahedron_shape({ball(0), ball(1), ball(2), ball(3)});
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t f = complex_.cell_triangles[cell_][k];
      if (f != kNoIndex) take_corner(complex_.triangles[f]);
    }
    out_.volume = shape_.volume;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!complex_.in_complex[v_[i]]) continue;
      const double r = ball(i).radius;
      out_.volume -= shape_.solid_angle[i] * r * r * r / 3;
      out_.area += shape_.solid_angle[i] * r * r;
    }
    for (std::size_t p = 0; p < 6; ++p) find_lens(p);
    for (std::size_t k = 0; k < 4; ++k) {
      if (complex_.cell_triangles[cell_][k] == kNoIndex) add_face(k);
    }
    return out_;
  }

 private:
  const Sphere& ball(std::size_t i) const { return t_.balls[v_[i]]; }

  // Pair 5 - p has the vertices that pair p lacks.
  static std::size_t pair_of(std::size_t i, std::size_t j) {
    for (std::size_t p = 0; p < 6; ++p) {
      if ((kPairs[p][0] == i && kPairs[p][1] == j) || (kPairs[p][0] == j && kPairs[p][1] == i)) {
        return p;
      }
    }
    return 6;
  }

  void take_corner(const DualTriangle& f) {
    const Sphere &a = t_.balls[f.vertices[0]], &b = t_.balls[f.vertices[1]],
                 &c = t_.balls[f.vertices[2]];
    const CornerShape corner = corner_shape(a, b, c, triangle_shape(a, b, c));
    shape_.volume -= corner.volume;
    for (std::size_t m = 0; m < 3; ++m) {
      const std::size_t i = slot_of_vertex(f.vertices[m]);
      shape_.solid_angle[i] -= corner.solid_angle[m];
      const std::size_t j = slot_of_vertex(f.vertices[(m + 1) % 3]),
                        l = slot_of_vertex(f.vertices[(m + 2) % 3]);
      shape_.dihedral[pair_of(j, l)] -= corner.dihedral[m];
    }
  }

  std::size_t slot_of_vertex(std::uint32_t v) const {
    return static_cast<std::size_t>(std::find(v_.begin(), v_.end(), v) - v_.begin());
  }

  void find_lens(std::size_t p) {
    const std::size_t i = kPairs[p][0], j = kPairs[p][1];
    if (dual_edge(complex_, v_[i], v_[j]) == kNoIndex) return;
    const EdgeShape edge = edge_shape(ball(i), ball(j));
    const double circle = std::sqrt(edge.squared_circle_radius);
    add_cap(lenses_[p], ball(i).radius, edge.height[0], circle);
    add_cap(lenses_[p], ball(j).radius, edge.height[1], circle);
    out_.volume += shape_.dihedral[p] / (2 * std::numbers::pi) * lenses_[p].volume;
    out_.area -= shape_.dihedral[p] / (2 * std::numbers::pi) * lenses_[p].area;
  }

  // The same sums in the plane of a face outside the complex.
  void add_face(std::size_t k) {
    const auto& f = kFacetVertices[k];
    const Vec3d a = ball(f[0]).center, b = ball(f[1]).center, c = ball(f[2]).center;
    double area = norm(cross(b - a, c - a)) / 2, rim = 0;
    for (std::size_t m = 0; m < 3; ++m) {
      const std::size_t i = f[m], j = f[(m + 1) % 3], l = f[(m + 2) % 3];
      const LensParts& lens = lenses_[pair_of(i, j)];
      area += lens.section;
      rim -= lens.arc;
      if (!complex_.in_complex[v_[i]]) continue;
      const Vec3d u = ball(j).center - ball(i).center, w = ball(l).center - ball(i).center;
      const double angle = std::atan2(norm(cross(u, w)), dot(u, w)), r = ball(i).radius;
      area -= angle * r * r / 2;
      rim += angle * r;
    }
    out_.face_area[k] = area;
    out_.face_rim[k] = rim;
  }

  const PowerTriangulation& t_;
  const DualComplex& complex_;
  const std::uint32_t cell_;
  const std::array<std::uint32_t, 4> v_;
  TetrahedronShape shape_{};  // less the corners over its faces
  std::array<LensParts, 6> lenses_{};
  CastpSums out_;
};

}  // namespace

std::uint32_t dual_edge(const DualComplex& complex, std::uint32_t a, std::uint32_t b) {
  const std::array<std::uint32_t, 2> wanted{std::min(a, b), std::max(a, b)};
  const auto found =
      std::lower_bound(complex.edges.begin(), complex.edges.end(), wanted,
                       [](const DualEdge& e, const auto& v) { return e.vertices < v; });
  if (found == complex.edges.end() || found->vertices != wanted) return kNoIndex;
  return static_cast<std::uint32_t>(found - complex.edges.begin());
}

CastpSums castp_sums(const PowerTriangulation& triangulation, const DualComplex& complex,
                     std::uint32_t cell) {
  return CastpFinder(triangulation, complex, cell).run();
}

}  // namespace vdwmesh
