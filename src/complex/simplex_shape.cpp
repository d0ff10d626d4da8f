// Shapes of edges, triangles and tetrahedra, evaluated in double or in 100 decimal digits.
//
// Every quantity is a quotient, a root or an angle of polynomials in the coordinates. Templates
// over the number type T write each formula once. is_thin(), is_flat() and is_short() decide
// whether double keeps enough digits of the polynomials; if not, T = WideFloat evaluates them
// again. Results are double in both cases.
//
// The orthogonal centre of two to four balls is the point in the line, plane or space of their
// centres that has the same power |x - c|² - r² to all of them. For balls a, b the half power
// offset w_b = (|ab|² + r_a² - r_b²) / 2 is the scalar product of ab and the vector from the centre
// of a to the orthogonal centre.
#include "complex/simplex_shape.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numbers>

#include "complex/number_vector.hpp"
#include "complex/power_triangulation.hpp"
#include "complex/wide_points.hpp"

namespace vdwmesh {
namespace {

// A triangle is thin if the sine of its smallest angle is below kThinSine. A tetrahedron is flat if
// six times its volume is below kFlatVolume times the product of the lengths of the three edges at
// ball 0. At kThinSine double loses three of its sixteen digits of an angle, which is right to
// 1e-13; at kFlatVolume it loses four of an orthogonal centre, which is right to 1e-12.
constexpr double kThinSine = 1e-3;
constexpr double kFlatVolume = 1e-4;

// A chord between the two points common to three spheres is short if half of it is below this
// fraction of the largest radius. The square of the half is a difference of squares of about that
// radius, and would lose six digits or more in double.
constexpr double kShortChord = 1e-3;

// The polynomials below have up to ten lengths in a product (the squares in common_point_terms()).
// If edges are at least kShortEdge = 2^-100 long, a product of ten is at least 2^-1000. The least
// normal double is 2^-1022, so nothing underflows.
constexpr double kLeastSquaredLength = kShortEdge * kShortEdge;

using numbers::from_to;
using numbers::Vector;
template <class T>
Vector<T> difference(const Vector<T>& a, const Vector<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// w_b = ab · (orthogonal centre - c_a).
template <class T>
T half_power_offset(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  return (dot(ab, ab) + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius))) * T(0.5);
}

// Only sums and differences lose digits by cancellation. Still, the roots and quotients of their
// results are computed in T too, because a double may not hold their arguments: the square of a
// length of 1e-170 underflows to 0. The conversion to double comes last.
double to_double(double value) { return value; }
double to_double(const WideFloat& value) { return static_cast<double>(value); }
double ratio(double a, double b) { return a / b; }
double ratio(const WideFloat& a, const WideFloat& b) { return static_cast<double>(a / b); }

// A negative square is a rounding error of 0, so its root is 0. The root of NaN is NaN.
double root(double square) { return square <= 0 ? 0 : std::sqrt(square); }

// The square root by Newton's iteration for the inverse root, which needs no division. A step
// doubles the number of correct bits: 53 from the double, 106, 212, 424, and WideFloat has 335. An
// even power of two is split off first, so that the mantissa fits a double.
WideFloat root(const WideFloat& square) {
  if (square <= 0) return 0;
  auto exponent = ilogb(square);
  exponent -= exponent % 2;                             // even, rounded towards 0
  const WideFloat mantissa = ldexp(square, -exponent);  // in [1/2, 4)
  WideFloat inverse = 1 / std::sqrt(to_double(mantissa));
  for (int step = 0; step < 3; ++step) {
    inverse += inverse * (1 - mantissa * inverse * inverse) / 2;
  }
  return ldexp(WideFloat(mantissa * inverse), exponent / 2);
}

// The angle of the vector (x, y) from the x axis, in [-π, π]. For WideFloat, both coordinates are
// first divided by the larger absolute value, so that they fit doubles. The zero vector has the
// angle 0.
double angle(double y, double x) { return std::atan2(y, x); }
double angle(const WideFloat& y, const WideFloat& x) {
  const WideFloat size = std::max<WideFloat>(abs(x), abs(y));
  return size > 0 ? std::atan2(to_double(WideFloat(y / size)), to_double(WideFloat(x / size)))
                  : 0.0;
}

// v / divisor. The quotient of each coordinate is computed in T.
template <class T>
Vec3d quotient(const Vector<T>& v, const T& divisor) {
  return {ratio(v.x, divisor), ratio(v.y, divisor), ratio(v.z, divisor)};
}

// The shape of a triangle. For the edge ab opposite to vertex c, with L = |ab|² and G = (twice the
// area)²:
//   distance of the orthogonal centre from the line ab, positive towards c:
//                                               (w_c L - w_b ab·ac) / sqrt(G L)
//   squared radius of the circle in which the spheres of a and b meet:
//                                               (r_a² L - w_b²) / L
//   half_chord², of the two points common to the three spheres:
//                                               the squared radius - distance²
// The variables that begin with "scaled" are their numerators.
template <class T>
TriangleShape shape_in(const std::array<const Sphere*, 3>& v) {
  const Vector<T> normal = cross(from_to<T>(*v[0], *v[1]), from_to<T>(*v[0], *v[2]));
  const T gram = dot(normal, normal), twice_area = root(gram);
  TriangleShape shape{};
  shape.twice_area = to_double(twice_area);
  double smallest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &a = *v[(k + 1) % 3], &b = *v[(k + 2) % 3], &c = *v[k];
    const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c);
    const T wb = half_power_offset(a, b, ab), wc = half_power_offset(a, c, ac);
    const T squared_length = dot(ab, ab), scale = twice_area * root(squared_length);
    const T scaled_distance = wc * squared_length - wb * dot(ab, ac);
    shape.distance[k] = ratio(scaled_distance, scale);
    // half_chord is the same for all three edges. The smallest circle gives it with the least
    // rounding.
    const T scaled_circle = T(a.radius) * T(a.radius) * squared_length - wb * wb;
    const double squared_circle_radius = ratio(scaled_circle, squared_length);
    if (k > 0 && squared_circle_radius >= smallest) continue;
    smallest = squared_circle_radius;
    const T scaled_chord = scaled_circle * gram - scaled_distance * scaled_distance;
    shape.half_chord = ratio(root(scaled_chord), scale);
  }
  return shape;
}

// Whether the triangle with the edge vectors u and v is too thin, or has an edge too short, for
// double. Twice the area over the product of the two longest edges is the sine of its smallest
// angle. The comparisons are written with !(... >= ...) so that NaN also counts as thin; is_short()
// and is_flat() do the same.
bool is_thin(const Vector<double>& u, const Vector<double>& v) {
  const double uu = dot(u, u), vv = dot(v, v);
  const Vector<double> w = difference(v, u), normal = cross(u, v);
  const double ww = dot(w, w);
  if (!(std::min({uu, vv, ww}) >= kLeastSquaredLength)) return true;
  const double two_longest = std::max({uu * vv, uu * ww, vv * ww});
  return !(dot(normal, normal) >= kThinSine * kThinSine * two_longest);
}

// Let x be a point common to the three spheres, and s the solid angle of the triangle p, q, x seen
// from o. Van Oosterom and Strackee 1983: tan(s / 2) = det(op, oq, ox) / d, with
//   d = |op| |oq| |ox| + (op·oq) |ox| + (op·ox) |oq| + (oq·ox) |op|.
// Returns d. Here |ox| is the radius of o, and op·ox, oq·ox are half power offsets.
template <class T>
T solid_angle_denominator(const Sphere& o, const Sphere& p, const Sphere& q) {
  const Vector<T> op = from_to<T>(o, p), oq = from_to<T>(o, q);
  const T lp = root(T(dot(op, op))), lq = root(T(dot(oq, oq)));
  return T(o.radius) * (lp * lq + dot(op, oq)) + half_power_offset(o, p, op) * lq +
         half_power_offset(o, q, oq) * lp;
}

// Whether half a chord is too short for double; see kShortChord.
bool is_short(double half_chord, const Sphere& a, const Sphere& b, const Sphere& c) {
  return !(half_chord >= kShortChord * std::max({a.radius, b.radius, c.radius}));
}

// The polynomials behind a tetrahedron's angles and heights, with the centre of ball 0 as origin.
// normal[k] is normal to the facet opposite to vertex k and as long as twice the facet's area. It
// points outward, because the triangulation gives tetrahedra of positive determinant.
template <class T>
struct TetrahedronTerms {
  std::array<Vector<T>, 3> edge;  // from ball 0 to balls 1, 2, 3
  std::array<Vector<T>, 4> normal;
  std::array<T, 4> squared_normal;
  T determinant;  // six times the volume

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

// The dihedral angle at an edge from the outward normals m and n of its facets, with |m × n| =
// determinant * |edge|: cosine ∝ -m·n, sine ∝ determinant * |edge|.
template <class T>
void set_dihedrals(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms,
                   TetrahedronShape& shape) {
  // A tetrahedron of volume 0 has the angles 0 and π. A negative value or a negative zero would
  // turn π into -π.
  const T determinant = terms.determinant <= 0 ? T(0) : terms.determinant;
  for (std::size_t p = 0; p < 6; ++p) {
    // The facets at an edge are those opposite to the other two vertices. The pairs are 01, 02, 03,
    // 12, 13 and 23, so these vertices are pair 5 - p.
    const auto &m = terms.normal[kPairs[5 - p][0]], &n = terms.normal[kPairs[5 - p][1]];
    const auto edge = from_to<T>(v[kPairs[p][0]], v[kPairs[p][1]]);
    shape.dihedral[p] = angle(T(determinant * root(T(dot(edge, edge)))), T(-dot(m, n)));
  }
}

// Returns -determinant * x for the orthogonal centre x, from ball 0. By Cramer's rule the solution
// of edge[k]·x = w[k] is a combination of the normals of the facets through ball 0; their sign is
// that of outward normals.
template <class T>
Vector<T> center_numerator(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms) {
  std::array<T, 3> w;
  for (std::size_t k = 0; k < 3; ++k) w[k] = half_power_offset(v[0], v[k + 1], terms.edge[k]);
  const auto& n = terms.normal;
  return {w[0] * n[1].x + w[1] * n[2].x + w[2] * n[3].x,
          w[0] * n[1].y + w[1] * n[2].y + w[2] * n[3].y,
          w[0] * n[1].z + w[1] * n[2].z + w[2] * n[3].z};
}

// Heights of the orthogonal centre x over the facets: -n·x / |n| for a facet through ball 0 with
// the outward normal n. center_numerator() gives -determinant * x.
template <class T>
void set_center_heights(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms,
                        TetrahedronShape& shape) {
  const Vector<T> center = center_numerator(v, terms);
  const T& d = terms.determinant;
  for (std::size_t k = 0; k < 4; ++k) {
    T scaled_height = dot(center, terms.normal[k]);
    if (k == 0) scaled_height += d * d;  // ball 0 is not on facet 0, but d / |n| above it
    shape.center_height[k] = ratio(scaled_height, T(d * root(terms.squared_normal[k])));
  }
}

// The points common to three spheres, times the squared normal |n|² = `gram` of the triangle. With
// u = ab, v = ac and n = u × v, the orthogonal centre in the plane is (w_u v×n + w_v n×u) / |n|².
// The points lie above and below it by sqrt(r_a² - |centre|²). All are relative to the centre of a.
// common_points_wide() adds one value to all squared radii: it moves the points, not the centre.
template <class T>
struct CommonPointTerms {
  Vector<T> normal, center;  // `center` is multiplied by `gram`, `squared_chord` by its square
  T gram, squared_chord;     // of half the chord; below 0 if the spheres do not meet
};

template <class T>
CommonPointTerms<T> common_point_terms(const Sphere& a, const Sphere& b, const Sphere& c,
                                       const T& added_square) {
  const Vector<T> u = from_to<T>(a, b), v = from_to<T>(a, c), n = cross(u, v);
  const Vector<T> vn = cross(v, n), nu = cross(n, u);
  const T wu = half_power_offset(a, b, u), wv = half_power_offset(a, c, v), gram = dot(n, n);
  const Vector<T> center{wu * vn.x + wv * nu.x, wu * vn.y + wv * nu.y, wu * vn.z + wv * nu.z};
  const T scaled_radius = T(a.radius) * gram;
  const T scaled_square = scaled_radius * scaled_radius + added_square * gram * gram;
  return {n, center, gram, T(scaled_square - dot(center, center))};
}

template <class T>
CommonPoints points_in(const Sphere& a, const Sphere& b, const Sphere& c) {
  const CommonPointTerms<T> terms = common_point_terms<T>(a, b, c, T(0));
  const double half_chord = ratio(root(terms.squared_chord), terms.gram);
  const T twice_area = root(terms.gram);
  const Vec3d middle = quotient(terms.center, terms.gram);
  const Vec3d lift = half_chord * quotient(terms.normal, twice_area);
  return {middle + lift, middle - lift, half_chord, to_double(twice_area)};
}

template <class T>
double size_in(const Sphere& a, const Sphere& b, const Sphere& c) {
  const CommonPointTerms<T> terms = common_point_terms<T>(a, b, c, T(0));
  return -ratio(terms.squared_chord, T(terms.gram * terms.gram));
}

// The shape of a tetrahedron. A solid angle is the sum of the dihedral angles at its three edges,
// less π: vertex 1 has the edges 01, 12 and 13, which are the pairs 0, 3 and 4.
template <class T>
TetrahedronShape shape_in(const std::array<Sphere, 4>& v, const TetrahedronTerms<T>& terms) {
  TetrahedronShape shape{};
  set_dihedrals(v, terms, shape);
  set_center_heights(v, terms, shape);
  const auto& d = shape.dihedral;
  shape.solid_angle = {d[0] + d[1] + d[2] - std::numbers::pi, d[0] + d[3] + d[4] - std::numbers::pi,
                       d[1] + d[3] + d[5] - std::numbers::pi,
                       d[2] + d[4] + d[5] - std::numbers::pi};
  shape.volume = to_double(terms.determinant) / 6;
  return shape;
}

// Whether the tetrahedron is too flat for double, or one of its facets too thin.
bool is_flat(const TetrahedronTerms<double>& terms) {
  const auto& e = terms.edge;
  const double ab = dot(e[0], e[0]), ac = dot(e[1], e[1]), ad = dot(e[2], e[2]);
  if (!(terms.determinant * terms.determinant >= kFlatVolume * kFlatVolume * ab * ac * ad)) {
    return true;
  }
  return is_thin(e[0], e[1]) || is_thin(e[0], e[2]) || is_thin(e[1], e[2]) ||
         is_thin(difference(e[1], e[0]), difference(e[2], e[0]));
}

// The shape of an edge. With h the height of the orthogonal centre over a ball's centre along the
// edge, the squared radius of the circle is r² - h² = (r - h)(r + h). It is computed on the smaller
// sphere, which has the smaller rounding error.
template <class T>
EdgeShape shape_in(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  const T length = root(T(dot(ab, ab)));
  const double at_a = ratio(half_power_offset(a, b, ab), length),
               at_b = ratio(half_power_offset(b, a, ab), length);  // |ba| = |ab|
  const bool a_smaller = a.radius < b.radius;
  const double radius = a_smaller ? a.radius : b.radius, height = a_smaller ? at_a : at_b;
  const double squared = (radius - height) * (radius + height);
  return {to_double(length), {at_a, at_b}, squared <= 0 ? 0 : squared};
}

template <class T>
T twice_area(const Sphere& a, const Sphere& b, const Sphere& c) {
  const Vector<T> normal = cross(from_to<T>(a, b), from_to<T>(a, c));
  return root(T(dot(normal, normal)));
}

// Returns the solid angles at the three centres of a corner tetrahedron: its vertices are these and
// one of the two points common to the spheres. `determinant` is the determinant of two edge vectors
// of the triangle and the vector to the common point, all from the same centre; it is the same for
// every centre.
template <class T>
std::array<double, 3> solid_angles(const std::array<const Sphere*, 3>& v, const T& determinant) {
  std::array<double, 3> angles;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere &o = *v[k], &p = *v[(k + 1) % 3], &q = *v[(k + 2) % 3];
    angles[k] = 2 * angle(determinant, solid_angle_denominator<T>(o, p, q));
  }
  return angles;
}

// Whether the three spheres have one common point and it lies on the line of an edge, where two of
// them touch. The corner tetrahedron is flat then and no centre lies within it, so its solid angles
// are 0. Their formula would be atan2(0, 0) at the end of the edge that is next to the point, and
// the rounding of the second 0 would decide between 0 and 2 π.
bool is_on_a_line(const TriangleShape& triangle) {
  const auto& d = triangle.distance;
  return triangle.half_chord == 0 && (d[0] == 0 || d[1] == 0 || d[2] == 0);
}

}  // namespace

EdgeShape edge_shape(const Sphere& a, const Sphere& b) {
  const Vector<double> ab = from_to<double>(a, b);
  if (!(dot(ab, ab) >= kLeastSquaredLength)) return shape_in(a, b, from_to<WideFloat>(a, b));
  return shape_in(a, b, ab);
}

TriangleShape triangle_shape(const Sphere& a, const Sphere& b, const Sphere& c) {
  const std::array<const Sphere*, 3> v{&a, &b, &c};
  if (is_thin(from_to<double>(a, b), from_to<double>(a, c))) return shape_in<WideFloat>(v);
  const TriangleShape shape = shape_in<double>(v);
  return is_short(shape.half_chord, a, b, c) ? shape_in<WideFloat>(v) : shape;
}

CommonPoints common_points(const Sphere& a, const Sphere& b, const Sphere& c) {
  if (is_thin(from_to<double>(a, b), from_to<double>(a, c))) return points_in<WideFloat>(a, b, c);
  const CommonPoints points = points_in<double>(a, b, c);
  return is_short(points.half_chord, a, b, c) ? points_in<WideFloat>(a, b, c) : points;
}

double orthogonal_size(const Sphere& a, const Sphere& b, const Sphere& c) {
  if (is_thin(from_to<double>(a, b), from_to<double>(a, c))) return size_in<WideFloat>(a, b, c);
  const double size = size_in<double>(a, b, c);
  return is_short(std::sqrt(std::abs(size)), a, b, c) ? size_in<WideFloat>(a, b, c) : size;
}

std::array<numbers::Vector<WideFloat>, 2> common_points_wide(const Sphere& a, const Sphere& b,
                                                             const Sphere& c,
                                                             const WideFloat& added_square) {
  const CommonPointTerms<WideFloat> terms = common_point_terms<WideFloat>(a, b, c, added_square);
  const WideFloat lift = root(terms.squared_chord) / (terms.gram * root(terms.gram));
  const auto at = [&](const WideFloat& center, const WideFloat& normal, const WideFloat& side) {
    return WideFloat(center / terms.gram + side * normal);
  };
  const auto point = [&](const WideFloat& side) {
    return Vector<WideFloat>{at(terms.center.x, terms.normal.x, side),
                             at(terms.center.y, terms.normal.y, side),
                             at(terms.center.z, terms.normal.z, side)};
  };
  return {point(lift), point(WideFloat(-lift))};
}

Vec3d orthogonal_center(const std::array<Sphere, 4>& balls) {
  const TetrahedronTerms<double> terms(balls);
  if (!is_flat(terms)) return quotient(center_numerator(balls, terms), -terms.determinant);
  const TetrahedronTerms<WideFloat> wide(balls);
  return quotient(center_numerator(balls, wide), WideFloat(-wide.determinant));
}

double corner_dihedral(const std::array<const Sphere*, 3>& balls, const TriangleShape& triangle,
                       std::size_t k) {
  // If the three spheres have one common point, on the line of the edge, atan2(0, 0) would give 0.
  // Between the ends, the angle is the limit for a chord that shrinks, with the distance 0: π / 2.
  if (triangle.half_chord == 0 && triangle.distance[k] == 0) {
    const Sphere &a = *balls[(k + 1) % 3], &b = *balls[(k + 2) % 3];
    const EdgeShape edge = edge_shape(a, b);
    if (edge.height[0] > 0 && edge.height[1] > 0) return std::numbers::pi / 2;
  }
  return std::atan2(triangle.half_chord, triangle.distance[k]);
}

CornerShape corner_shape(const Sphere& a, const Sphere& b, const Sphere& c,
                         const TriangleShape& triangle) {
  const std::array<const Sphere*, 3> v{&a, &b, &c};
  const bool wide = is_thin(from_to<double>(a, b), from_to<double>(a, c)) ||
                    is_short(triangle.half_chord, a, b, c);
  CornerShape corner{};
  if (!is_on_a_line(triangle)) {
    // The wide angles take half_chord as a double, in which triangle_shape() rounded a wide result.
    corner.solid_angle = wide ? solid_angles<WideFloat>(v, twice_area<WideFloat>(a, b, c) *
                                                               WideFloat(triangle.half_chord))
                              : solid_angles<double>(v, triangle.twice_area * triangle.half_chord);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    corner.dihedral[k] = corner_dihedral(v, triangle, k);
  }
  corner.volume = triangle.twice_area * triangle.half_chord / 6;
  return corner;
}

TetrahedronShape tetrahedron_shape(const std::array<Sphere, 4>& balls) {
  const TetrahedronTerms<double> terms(balls);
  if (is_flat(terms)) return shape_in(balls, TetrahedronTerms<WideFloat>(balls));
  return shape_in(balls, terms);
}

}  // namespace vdwmesh
