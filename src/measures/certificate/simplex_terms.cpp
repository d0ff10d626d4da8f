// The terms of edges, triangles and tetrahedra, in any type of interval.
//
// Notation: for balls a, b the half power offset w_b = (|ab|² + r_a² - r_b²) / 2 is the scalar
// product of ab and any point of the radical plane, taken from the centre of a.
#include "measures/certificate/simplex_terms.hpp"

#include "complex/number_vector.hpp"
#include "complex/power_triangulation.hpp"
#include "measures/certificate/wide_interval.hpp"

namespace vdwmesh::certificate {
namespace {

using numbers::cross;
using numbers::dot;
using numbers::from_to;
using numbers::Vector;

template <class T>
T squared_length(const Vector<T>& v) {
  return square(v.x) + square(v.y) + square(v.z);
}

template <class T>
T half_power_offset(const Sphere& a, const Sphere& b, const T& squared_length) {
  return (squared_length + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius))) * T(0.5);
}

// Sums in T, while a simplex is evaluated.
template <class T>
struct Pair {
  T area{0.0}, volume{0.0};

  void add(const T& factor, const MeasureTerms& terms) {
    area = area + factor * T(terms.area);
    volume = volume + factor * T(terms.volume);
  }
  // Adds the cone over a solid angle of a ball.
  void add_cone(const T& solid_angle, double radius) {
    const T r(radius), piece = solid_angle * square(r);
    area = area + piece;
    volume = volume + piece * r / T(3.0);
  }
};

template <class T>
MeasureTerms enclosed(const Pair<T>& sums) {
  return {enclosure(sums.area), enclosure(sums.volume)};
}

// Heights of the radical plane over both centres, and the squared radius of the circle in it.
template <class T>
struct RadicalCircle {
  std::array<T, 2> heights{};
  T squared_radius{0.0};
};

// The plane cuts both balls. The squared radius r² - h² = (r - h)(r + h) is taken on the smaller
// ball, where it has the smaller rounding error.
template <class T>
RadicalCircle<T> circle_of(const std::array<Sphere, 2>& balls) {
  const T squared = squared_length(from_to<T>(balls[0], balls[1])), length = root(squared);
  RadicalCircle<T> circle;
  for (std::size_t k = 0; k < 2; ++k) {
    const double r = balls[k].radius;
    circle.heights[k] = within(-r, r, half_power_offset(balls[k], balls[1 - k], squared) / length);
  }
  const std::size_t small = balls[0].radius < balls[1].radius ? 0 : 1;
  const T r(balls[small].radius), h = circle.heights[small];
  circle.squared_radius = at_least_zero((r - h) * (r + h));
  return circle;
}

// Signed distances of a triangle's orthogonal centre from its edges, positive towards the vertices
// opposite to them, and half the chord between the points common to the three spheres.
template <class T>
struct IntervalTriangle {
  std::array<T, 3> distance{};
  T half_chord{0.0}, twice_area;
};

// For the edge ab opposite to c, with L = |ab|² and G = (twice the area of the triangle)²:
//   distance       = (w_c L - w_b ab·ac) / sqrt(G L)
//   squared circle = (r_a² L - w_b²) / L
//   half chord²    = squared circle - distance²
// Every edge gives the half chord; the smallest circle gives it with the least rounding. Both are
// at most r_a, because the points are in ball a. Without exposed corners no half chord is needed,
// and it is left at 0.
template <class T>
IntervalTriangle<T> shape_of(const std::array<Sphere, 3>& v, int corners) {
  const T gram = squared_length(cross(from_to<T>(v[0], v[1]), from_to<T>(v[0], v[2])));
  IntervalTriangle<T> shape;
  shape.twice_area = root(gram);
  double smallest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &a = v[(k + 1) % 3], &b = v[(k + 2) % 3], &c = v[k];
    const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c);
    const T bb = squared_length(ab), wb = half_power_offset(a, b, bb),
            wc = half_power_offset(a, c, squared_length(ac)), scale = shape.twice_area * root(bb);
    const T reach = wc * bb - wb * dot(ab, ac);
    shape.distance[k] = within(-a.radius, a.radius, reach / scale);
    if (corners == 0) continue;
    const T circle = square(T(a.radius)) * bb - square(wb);
    const double size = middle(circle) / middle(bb);
    if (k > 0 && !(size < smallest)) continue;
    smallest = size;
    shape.half_chord = within(0, a.radius, root(circle * gram - square(reach)) / scale);
  }
  return shape;
}

// The solid angle at o that p, q and a point x common to the three spheres span, by the formula of
// Van Oosterom and Strackee 1983. `determinant` is that of op, oq and ox.
template <class T>
T corner_solid_angle(const Sphere& o, const Sphere& p, const Sphere& q, const T& determinant) {
  const Vector<T> op = from_to<T>(o, p), oq = from_to<T>(o, q);
  const T pp = squared_length(op), qq = squared_length(oq), lp = root(pp), lq = root(qq);
  const T denominator = T(o.radius) * (lp * lq + dot(op, oq)) + half_power_offset(o, p, pp) * lq +
                        half_power_offset(o, q, qq) * lp;
  return T(2.0) * angle(determinant, denominator);
}

// The terms of one corner tetrahedron, and of the chord up to the corner.
template <class T>
Pair<T> corner_terms(const TriangleInput& in, const IntervalTriangle<T>& shape, const T& chord) {
  const auto& v = in.balls;
  const T determinant = shape.twice_area * shape.half_chord;
  Pair<T> sums;
  sums.volume = chord * shape.half_chord;
  for (std::size_t k = 0; k < 3; ++k) {
    const EdgeTerms& edge = *in.edges[k];
    if (edge.has_angle) sums.add(angle(shape.half_chord, shape.distance[k]), edge.free_angle);
    if (!in.roles[k].exposed) continue;
    const T taken = corner_solid_angle<T>(v[k], v[(k + 1) % 3], v[(k + 2) % 3], determinant);
    sums.add_cone(-taken, v[k].radius);
  }
  return sums;
}

// The polynomials behind a tetrahedron's angles and heights. The normals are outward and as long as
// twice the area of their facets. The determinant is six times the volume.
template <class T>
struct CellShape {
  std::array<Vector<T>, 3> edge;  // from ball 0
  std::array<Vector<T>, 4> normal;
  T determinant;

  explicit CellShape(const std::array<Sphere, 4>& v) {
    for (std::size_t k = 0; k < 3; ++k) edge[k] = from_to<T>(v[0], v[k + 1]);
    normal = {cross(from_to<T>(v[1], v[2]), from_to<T>(v[1], v[3])), cross(edge[2], edge[1]),
              cross(edge[0], edge[2]), cross(edge[1], edge[0])};
    determinant = -dot(edge[0], normal[1]);
  }

  // Minus the determinant times the orthogonal centre x, from ball 0. The centre satisfies
  // edge·x = w for the three edges; this is Cramer's rule.
  Vector<T> center_numerator(const std::array<Sphere, 4>& v) const {
    Vector<T> sum{T(0.0), T(0.0), T(0.0)};
    for (std::size_t k = 0; k < 3; ++k) {
      const T w = half_power_offset(v[0], v[k + 1], squared_length(edge[k]));
      const Vector<T>& n = normal[k + 1];
      sum = {sum.x + w * n.x, sum.y + w * n.y, sum.z + w * n.z};
    }
    return sum;
  }
};

// Adds what depends on the angles. The dihedral angle at an edge between facets with the normals m
// and n has a sine ∝ determinant × |edge| and a cosine ∝ -m·n. Pair 5 - p of the vertices are the
// two that pair p lacks, and the facets at an edge are those opposite to them.
template <class T>
void add_angles(const CellInput& in, const CellShape<T>& shape, Pair<T>& sums) {
  for (std::size_t p = 0; p < 6; ++p) {
    if (!in.edges[p]->has_angle) continue;
    const auto &m = shape.normal[kPairs[5 - p][0]], &n = shape.normal[kPairs[5 - p][1]];
    const Vector<T> edge = from_to<T>(in.balls[kPairs[p][0]], in.balls[kPairs[p][1]]);
    const T sine = shape.determinant * root(squared_length(edge));
    sums.add(angle(sine, -dot(m, n)), in.edges[p]->cell_angle);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    if (in.roles[k].exposed) sums.add_cone(pi(sums.area), in.balls[k].radius);
  }
}

// Adds the heights of the orthogonal centre x over the facets, -n·x / |n|, times D. Ball 0 is not
// on facet 0, but determinant / |n| above it. No height is greater than the radius of a ball on the
// facet, because the centre is in all balls.
template <class T>
void add_heights(const CellInput& in, const CellShape<T>& shape, Pair<T>& sums) {
  const Vector<T> center = shape.center_numerator(in.balls);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<T>& n = shape.normal[k];
    T reach = dot(center, n);
    if (k == 0) reach = reach + square(shape.determinant);
    const double radius = in.balls[k == 0 ? 1 : 0].radius;
    const T height = within(-radius, radius, reach / (shape.determinant * root(squared_length(n))));
    sums.volume = sums.volume + height * T(*in.chords[k]);
  }
}

}  // namespace

template <class T>
EdgeTerms edge_terms(const std::array<Sphere, 2>& balls, const std::array<Role, 2>& roles,
                     bool exposed) {
  const RadicalCircle<T> circle = circle_of<T>(balls);
  T height(0.0);
  Pair<T> free, cones;
  for (std::size_t k = 0; k < 2; ++k) {
    const T r(balls[k].radius), cap = r - circle.heights[k];
    if (roles[k].measured) height = height + circle.heights[k];
    if (!roles[k].exposed) continue;
    cones.add_cone(T(1.0), balls[k].radius);
    free.area = free.area + r * cap;
    free.volume = free.volume + square(r) * cap / T(3.0);
  }
  free.volume = free.volume - height * circle.squared_radius / T(6.0);
  if (!exposed) free = {};
  EdgeTerms out;
  out.height = enclosure(height);
  out.free_angle = enclosed(free);
  out.cell_angle = enclosed(Pair<T>{free.area - cones.area, free.volume - cones.volume});
  out.has_angle =
      roles[0].exposed || roles[1].exposed || (exposed && (roles[0].measured || roles[1].measured));
  return out;
}

template <class T>
TriangleTerms triangle_terms(const TriangleInput& in) {
  const IntervalTriangle<T> shape = shape_of<T>(in.balls, in.corners);
  T chord(0.0);
  for (std::size_t k = 0; k < 3; ++k) {
    chord = chord + shape.distance[k] * T(in.edges[k]->height);
  }
  chord = chord / T(6.0);
  TriangleTerms out;
  out.chord = enclosure(chord);
  if (in.corners == 0) return out;
  const Pair<T> corner = corner_terms(in, shape, chord);
  const T corners(static_cast<double>(in.corners));
  out.corners = enclosed(Pair<T>{corners * corner.area, corners * corner.volume});
  return out;
}

template <class T>
MeasureTerms cell_terms(const CellInput& in) {
  const CellShape<T> shape(in.balls);
  Pair<T> sums;
  add_angles(in, shape, sums);
  add_heights(in, shape, sums);
  return enclosed(sums);
}

template EdgeTerms edge_terms<Interval>(const std::array<Sphere, 2>&, const std::array<Role, 2>&,
                                        bool);
template EdgeTerms edge_terms<WideInterval>(const std::array<Sphere, 2>&,
                                            const std::array<Role, 2>&, bool);
template TriangleTerms triangle_terms<Interval>(const TriangleInput&);
template TriangleTerms triangle_terms<WideInterval>(const TriangleInput&);
template MeasureTerms cell_terms<Interval>(const CellInput&);
template MeasureTerms cell_terms<WideInterval>(const CellInput&);

}  // namespace vdwmesh::certificate
