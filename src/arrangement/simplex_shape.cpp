#include "arrangement/simplex_shape.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>

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

template <class T>
struct Vector {
  T x, y, z;
};

template <class T>
Vector<T> from_to(const Sphere& a, const Sphere& b) {
  return {T(b.center.x) - T(a.center.x), T(b.center.y) - T(a.center.y),
          T(b.center.z) - T(a.center.z)};
}
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
Vector<T> difference(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// (c_b - c_a) · (orthogonal centre - c_a).
template <class T>
T half_power_offset(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  return (dot(ab, ab) + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius))) / 2;
}

// Signed distance at edge ab, towards c.
template <class T>
T distance_in_plane(const Sphere& a, const Sphere& b, const Sphere& c, const T& twice_area) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c);
  const T wb = half_power_offset(a, b, ab), wc = half_power_offset(a, c, ac);
  using std::sqrt;
  const T squared_length = dot(ab, ab);
  return (wc * squared_length - wb * dot(ab, ac)) / (twice_area * T(sqrt(squared_length)));
}

template <class T>
TriangleShape shape_in(const std::array<const Sphere*, 3>& v) {
  using std::sqrt;
  const Vector<T> normal = cross(from_to<T>(*v[0], *v[1]), from_to<T>(*v[0], *v[2]));
  const T twice_area = sqrt(dot(normal, normal));
  TriangleShape shape{};
  shape.twice_area = static_cast<double>(twice_area);
  T smallest = 0;
  T squared_chord = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &a = *v[(k + 1) % 3], &b = *v[(k + 2) % 3];
    const T d = distance_in_plane(a, b, *v[k], twice_area);
    shape.distance[k] = static_cast<double>(d);
    // The smallest of the three circles gives the chord with the least rounding.
    const Vector<T> ab = from_to<T>(a, b);
    const T height = half_power_offset(a, b, ab) / T(sqrt(dot(ab, ab)));
    const T circle = (T(a.radius) - height) * (T(a.radius) + height);
    if (k == 0 || circle < smallest) {
      smallest = circle;
      squared_chord = circle - d * d;
    }
  }
  shape.half_chord = squared_chord > 0 ? static_cast<double>(T(sqrt(squared_chord))) : 0.0;
  return shape;
}

bool is_thin(const Vector<double>& u, const Vector<double>& v) {
  const double uu = dot(u, u), vv = dot(v, v);
  const Vector<double> w = difference(v, u), normal = cross(u, v);
  const double ww = dot(w, w);
  const double two_longest = std::max({uu * vv, uu * ww, vv * ww});
  return !(dot(normal, normal) >= kThinSine * kThinSine * two_longest);
}

// Van Oosterom and Strackee 1983: the tangent of half the solid angle that p, q and a point common
// to the three spheres span at o is their determinant over this.
template <class T>
double solid_angle_denominator(const Sphere& o, const Sphere& p, const Sphere& q) {
  using std::sqrt;
  const Vector<T> op = from_to<T>(o, p), oq = from_to<T>(o, q);
  const T lp = sqrt(dot(op, op)), lq = sqrt(dot(oq, oq));
  return static_cast<double>(T(T(o.radius) * (lp * lq + dot(op, oq)) +
                               half_power_offset(o, p, op) * lq +
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
  using std::sqrt;
  for (std::size_t p = 0; p < 6; ++p) {
    // The facets at an edge are those opposite to the other two vertices.
    const auto &m = terms.normal[kPairs[5 - p][0]], &n = terms.normal[kPairs[5 - p][1]];
    const Vector<T> edge = from_to<T>(v[kPairs[p][0]], v[kPairs[p][1]]);
    const T sine = terms.determinant * T(sqrt(dot(edge, edge)));
    shape.dihedral[p] =
        std::atan2(std::max(0.0, static_cast<double>(sine)), -static_cast<double>(dot(m, n)));
  }
}

template <class T>
Vector<T> center_of(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms) {
  std::array<T, 3> w;
  for (std::size_t k = 0; k < 3; ++k) w[k] = half_power_offset(v[0], v[k + 1], terms.edge[k]);
  const auto along = [&](auto coordinate) {
    return T((w[0] * coordinate(terms.normal[1]) + w[1] * coordinate(terms.normal[2]) +
              w[2] * coordinate(terms.normal[3])) /
             -terms.determinant);
  };
  return {along([](const Vector<T>& n) { return n.x; }),
          along([](const Vector<T>& n) { return n.y; }),
          along([](const Vector<T>& n) { return n.z; })};
}

template <class T>
void set_center_heights(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms,
                        TetrahedronShape& shape) {
  using std::sqrt;
  const Vector<T> center = center_of(v, terms);
  const Vector<T> from_first = difference(center, terms.edge[0]);
  for (std::size_t k = 0; k < 4; ++k) {
    const T reach = -dot(k == 0 ? from_first : center, terms.normal[k]);
    shape.center_height[k] = static_cast<double>(T(reach / T(sqrt(terms.squared_normal[k]))));
  }
}

// The centre in the plane by the Gram matrix of the two edges at a.
template <class T>
CommonPoints points_in(const Sphere& a, const Sphere& b, const Sphere& c) {
  using std::sqrt;
  const Vector<T> u = from_to<T>(a, b), v = from_to<T>(a, c), n = cross(u, v);
  const T wu = half_power_offset(a, b, u), wv = half_power_offset(a, c, v);
  const T uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), gram = dot(n, n);
  const T s = (wu * vv - wv * uv) / gram, t = (wv * uu - wu * uv) / gram;
  const Vector<T> center{s * u.x + t * v.x, s * u.y + t * v.y, s * u.z + t * v.z};
  const T squared_chord = T(a.radius) * T(a.radius) - dot(center, center);
  const T half_chord = squared_chord > 0 ? T(sqrt(squared_chord)) : T(0);
  const T lift = half_chord / T(sqrt(gram));
  const auto point = [&](const T& step) {
    return Vec3d{static_cast<double>(T(center.x + step * n.x)),
                 static_cast<double>(T(center.y + step * n.y)),
                 static_cast<double>(T(center.z + step * n.z))};
  };
  return {point(lift), point(T(-lift)), static_cast<double>(half_chord),
          static_cast<double>(T(sqrt(gram)))};
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
  const auto rounded = [](const auto& v) {
    return Vec3d{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
  };
  const TetrahedronTerms<double> terms(balls);
  if (is_flat(terms)) return rounded(center_of(balls, TetrahedronTerms<Wide>(balls)));
  return rounded(center_of(balls, terms));
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
