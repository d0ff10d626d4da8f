#include "arrangement/simplex_shape.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>

#include "arrangement/number_vector.hpp"

namespace vdwmesh {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_100;

// Sine of the angle below which a triangle is thin, and volume by edge lengths below which a
// tetrahedron is flat. An angle or a centre loses as many digits as these have zeros, so double
// keeps 1e-13 Å of a thin-limit triangle and 1e-12 Å of a flat-limit orthogonal centre.
constexpr double kThinSine = 1e-3;
constexpr double kFlatVolume = 1e-4;

// Half chord by radius below which its square is too small a difference for double.
constexpr double kShortChord = 1e-3;

using numbers::from_to;
using numbers::Vector;
template <class T>
Vector<T> difference(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// (c_b - c_a) · (orthogonal centre - c_a).
template <class T>
T half_power_offset(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  return (dot(ab, ab) + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius))) * T(0.5);
}

// Sums and products alone cancel, so they alone are done in T; roots and quotients of their results
// are left to double.
template <class T>
double to_double(const T& value) {
  return static_cast<double>(value);
}
template <class T>
double root(const T& square) {
  return std::sqrt(std::max(0.0, to_double(square)));
}
template <class T>
Vec3d quotient(const Vector<T>& v, double divisor) {
  return {to_double(v.x) / divisor, to_double(v.y) / divisor, to_double(v.z) / divisor};
}

template <class T>
TriangleShape shape_in(const std::array<const Sphere*, 3>& v) {
  const Vector<T> normal = cross(from_to<T>(*v[0], *v[1]), from_to<T>(*v[0], *v[2]));
  const T gram = dot(normal, normal);
  TriangleShape shape{};
  shape.twice_area = root(gram);
  double smallest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &a = *v[(k + 1) % 3], &b = *v[(k + 2) % 3], &c = *v[k];
    const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c);
    const T wb = half_power_offset(a, b, ab), wc = half_power_offset(a, c, ac);
    const T squared_length = dot(ab, ab);
    const T distance = wc * squared_length - wb * dot(ab, ac);
    shape.distance[k] = to_double(distance) / (shape.twice_area * root(squared_length));
    // The smallest of the three circles gives the chord with the least rounding.
    const T circle = T(a.radius) * T(a.radius) * squared_length - wb * wb;
    const double squared_circle_radius = to_double(circle) / to_double(squared_length);
    if (k > 0 && squared_circle_radius >= smallest) continue;
    smallest = squared_circle_radius;
    const T chord = circle * gram - distance * distance;
    shape.half_chord = root(chord) / (shape.twice_area * root(squared_length));
  }
  return shape;
}

bool is_thin(const Vector<double>& u, const Vector<double>& v) {
  const double uu = dot(u, u), vv = dot(v, v);
  const Vector<double> w = difference(v, u), normal = cross(u, v);
  const double ww = dot(w, w);
  const double two_longest = std::max({uu * vv, uu * ww, vv * ww});
  return !(dot(normal, normal) >= kThinSine * kThinSine * two_longest);
}

double square_root(double square) { return std::sqrt(square); }

// Newton from the double root; each step adds about 50 bits.
Wide square_root(const Wide& square) {
  const double start = std::sqrt(to_double(square));
  Wide root = start;
  const Wide slope = 0.5 / start;
  for (int step = 0; step < 3; ++step) root += (square - root * root) * slope;
  return root;
}

// Van Oosterom and Strackee 1983: the tangent of half the solid angle that p, q and a point common
// to the three spheres span at o is their determinant over this.
template <class T>
double solid_angle_denominator(const Sphere& o, const Sphere& p, const Sphere& q) {
  const Vector<T> op = from_to<T>(o, p), oq = from_to<T>(o, q);
  const T lp = square_root(dot(op, op)), lq = square_root(dot(oq, oq));
  return to_double(T(T(o.radius) * (lp * lq + dot(op, oq)) + half_power_offset(o, p, op) * lq +
                     half_power_offset(o, q, oq) * lp));
}

bool is_short(double half_chord, const Sphere& a, const Sphere& b, const Sphere& c) {
  return !(half_chord >= kShortChord * std::max({a.radius, b.radius, c.radius}));
}

// The polynomials behind a tetrahedron's angles and heights, relative to ball 0.
template <class T>
struct TetrahedronTerms {
  std::array<Vector<T>, 3> edge;    // from ball 0
  std::array<Vector<T>, 4> normal;  // of the facet opposite to k, outward, twice its area
  std::array<T, 4> squared_normal;
  T determinant;

  explicit TetrahedronTerms(const std::array<Sphere, 4>& v) {
    for (std::size_t k = 0; k < 3; ++k) edge[k] = from_to<T>(v[0], v[k + 1]);
    normal[1] = cross(edge[2], edge[1]);
    normal[2] = cross(edge[0], edge[2]);
    normal[3] = cross(edge[1], edge[0]);
    normal[0] = cross(difference(edge[1], edge[0]), difference(edge[2], edge[0]));
    for (std::size_t k = 0; k < 4; ++k) squared_normal[k] = dot(normal[k], normal[k]);
    determinant = -dot(edge[0], normal[1]);
  }
};

constexpr std::array<std::array<std::uint8_t, 2>, 6> kPairs{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

template <class T>
void set_dihedrals(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms,
                   TetrahedronShape& shape) {
  const double determinant = std::max(0.0, to_double(terms.determinant));
  for (std::size_t p = 0; p < 6; ++p) {
    // The facets at an edge are those opposite to the other two vertices.
    const auto &m = terms.normal[kPairs[5 - p][0]], &n = terms.normal[kPairs[5 - p][1]];
    const auto edge = from_to<double>(v[kPairs[p][0]], v[kPairs[p][1]]);
    shape.dihedral[p] = std::atan2(determinant * root(dot(edge, edge)), -to_double(dot(m, n)));
  }
}

// The orthogonal centre, from ball 0, times minus the determinant.
template <class T>
Vector<T> center_numerator(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms) {
  std::array<T, 3> w;
  for (std::size_t k = 0; k < 3; ++k) w[k] = half_power_offset(v[0], v[k + 1], terms.edge[k]);
  const auto& n = terms.normal;
  return {w[0] * n[1].x + w[1] * n[2].x + w[2] * n[3].x,
          w[0] * n[1].y + w[1] * n[2].y + w[2] * n[3].y,
          w[0] * n[1].z + w[1] * n[2].z + w[2] * n[3].z};
}

template <class T>
void set_center_heights(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms,
                        TetrahedronShape& shape) {
  const Vector<T> center = center_numerator(v, terms);
  const T& d = terms.determinant;
  for (std::size_t k = 0; k < 4; ++k) {
    T reach = dot(center, terms.normal[k]);
    if (k == 0) reach += d * d;  // this facet alone does not pass through ball 0
    shape.center_height[k] = to_double(reach) / (to_double(d) * root(terms.squared_normal[k]));
  }
}

// The centre in the plane is (wu v×n + wv n×u) / n².
template <class T>
CommonPoints points_in(const Sphere& a, const Sphere& b, const Sphere& c) {
  const Vector<T> u = from_to<T>(a, b), v = from_to<T>(a, c), n = cross(u, v);
  const Vector<T> vn = cross(v, n), nu = cross(n, u);
  const T wu = half_power_offset(a, b, u), wv = half_power_offset(a, c, v), gram = dot(n, n);
  const Vector<T> center{wu * vn.x + wv * nu.x, wu * vn.y + wv * nu.y, wu * vn.z + wv * nu.z};
  const T scaled_radius = T(a.radius) * gram;
  const double half_chord =
      root(T(scaled_radius * scaled_radius - dot(center, center))) / to_double(gram);
  const double twice_area = root(gram);
  const Vec3d middle = quotient(center, to_double(gram));
  const Vec3d lift = half_chord * quotient(n, twice_area);
  return {middle + lift, middle - lift, half_chord, twice_area};
}

template <class T>
TetrahedronShape shape_in(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms) {
  TetrahedronShape shape{};
  set_dihedrals(v, terms, shape);
  set_center_heights(v, terms, shape);
  const auto& d = shape.dihedral;
  constexpr double kPi = std::numbers::pi;
  shape.solid_angle = {d[0] + d[1] + d[2] - kPi, d[0] + d[3] + d[4] - kPi, d[1] + d[3] + d[5] - kPi,
                       d[2] + d[4] + d[5] - kPi};
  shape.volume = static_cast<double>(terms.determinant) / 6;
  return shape;
}

bool is_flat(const TetrahedronTerms<double>& terms) {
  const auto& e = terms.edge;
  const double ab = dot(e[0], e[0]), ac = dot(e[1], e[1]), ad = dot(e[2], e[2]);
  if (!(terms.determinant * terms.determinant >= kFlatVolume * kFlatVolume * ab * ac * ad)) {
    return true;
  }
  return is_thin(e[0], e[1]) || is_thin(e[0], e[2]) || is_thin(e[1], e[2]) ||
         is_thin(difference(e[1], e[0]), difference(e[2], e[0]));
}

}  // namespace

EdgeShape edge_shape(const Sphere& a, const Sphere& b) {
  const Vector<double> ab = from_to<double>(a, b);
  const double length = std::sqrt(dot(ab, ab));
  const double at_a = half_power_offset(a, b, ab) / length,
               at_b = half_power_offset(b, a, ab) / length;
  const bool a_smaller = a.radius < b.radius;
  const double radius = a_smaller ? a.radius : b.radius, height = a_smaller ? at_a : at_b;
  return {length, {at_a, at_b}, std::max(0.0, (radius - height) * (radius + height))};
}

TriangleShape triangle_shape(const Sphere& a, const Sphere& b, const Sphere& c) {
  const std::array<const Sphere*, 3> v{&a, &b, &c};
  if (is_thin(from_to<double>(a, b), from_to<double>(a, c))) return shape_in<Wide>(v);
  const TriangleShape shape = shape_in<double>(v);
  return is_short(shape.half_chord, a, b, c) ? shape_in<Wide>(v) : shape;
}

CommonPoints common_points(const Sphere& a, const Sphere& b, const Sphere& c) {
  if (is_thin(from_to<double>(a, b), from_to<double>(a, c))) return points_in<Wide>(a, b, c);
  const CommonPoints points = points_in<double>(a, b, c);
  return is_short(points.half_chord, a, b, c) ? points_in<Wide>(a, b, c) : points;
}

Vec3d orthogonal_center(const std::array<Sphere, 4>& balls) {
  const TetrahedronTerms<double> terms(balls);
  if (!is_flat(terms)) return quotient(center_numerator(balls, terms), -terms.determinant);
  const TetrahedronTerms<Wide> wide(balls);
  return quotient(center_numerator(balls, wide), -to_double(wide.determinant));
}

CornerShape corner_shape(const Sphere& a, const Sphere& b, const Sphere& c,
                         const TriangleShape& triangle) {
  const std::array<const Sphere*, 3> v{&a, &b, &c};
  const bool wide = is_thin(from_to<double>(a, b), from_to<double>(a, c)) ||
                    is_short(triangle.half_chord, a, b, c);
  const double determinant = triangle.twice_area * triangle.half_chord;
  CornerShape corner{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &o = *v[k], &p = *v[(k + 1) % 3], &q = *v[(k + 2) % 3];
    const double denominator =
        wide ? solid_angle_denominator<Wide>(o, p, q) : solid_angle_denominator<double>(o, p, q);
    corner.solid_angle[k] = 2 * std::atan2(determinant, denominator);
    corner.dihedral[k] = std::atan2(triangle.half_chord, triangle.distance[k]);
  }
  corner.volume = determinant / 6;
  return corner;
}

TetrahedronShape tetrahedron_shape(const std::array<Sphere, 4>& balls) {
  const TetrahedronTerms<double> terms(balls);
  if (is_flat(terms)) return shape_in(balls, TetrahedronTerms<Wide>(balls));
  return shape_in(balls, terms);
}

}  // namespace vdwmesh
