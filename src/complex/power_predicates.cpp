// The predicates as polynomials: a floating-point filter first, then exact arithmetic.
//
// Each function whose name ends in _value evaluates one polynomial in any number type T. For double
// it also gives `magnitude`, a bound of the sum of absolute values of all terms. filtered_sign()
// accepts the double's sign if the value exceeds the rounding error (a standard forward error
// bound), and otherwise evaluates the same polynomial in CGAL's exact ring numbers. The sign is
// that of the polynomial, however the double was computed.
//
// Notation: vectors ab, ac, ad from the centre of a; w_b = |ab|² + r_a² - r_b², and so on. The
// centre x of an orthogonal sphere, taken from the centre of a, satisfies 2 ab·x = w_b, 2 ac·x =
// w_c, ..., and its squared radius is |x|² - r_a².
#include "complex/power_predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "complex/number_vector.hpp"

namespace vdwmesh {
namespace {

using Exact = CGAL::internal::Exact_ring_selector<double>::Type;

// Unit roundoff of double. The first argument of filtered_sign() is at least the number of
// roundings on the longest path from an input to the value of the polynomial. To a difference of
// coordinates there is 1, to a scalar product or a cofactor 5, to a determinant 9, to a power
// offset w 6.
constexpr double kRoundoff = std::numeric_limits<double>::epsilon() / 2;
// A smaller error bound may itself have lost digits to underflow, so the filter does not use it.
constexpr double kTinyBound = 1e-280;

using numbers::from_to;
using numbers::Vector;

template <class T>
T squared_radius(const Sphere& a) {
  return T(a.radius) * T(a.radius);
}

// w_b: the power of the centre of a with respect to b, plus r_a². It is twice the scalar product of
// ab with any orthogonal centre x.
template <class T>
T power_offset(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  return dot(ab, ab) + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius));
}

// det(ab, ac, ad): six times the signed volume of the tetrahedron.
template <class T>
T orientation_value(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d,
                    double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c), ad = from_to<T>(a, d);
  if constexpr (std::is_same_v<T, double>) {
    *magnitude = 3 * std::sqrt(dot(ab, ab) * dot(ac, ac) * dot(ad, ad));
  }
  return dot(cross(ab, ac), ad);
}

// Minus the lifted determinant with the rows (a, w_a), (b, w_b), (c, w_c), (d, w_d), where a to d
// are the vectors from t to p, q, r, s, expanded by its last column.
template <class T>
T power_side_value(const Sphere& p, const Sphere& q, const Sphere& r, const Sphere& s,
                   const Sphere& t, double* magnitude) {
  const Vector<T> a = from_to<T>(t, p), b = from_to<T>(t, q), c = from_to<T>(t, r),
                  d = from_to<T>(t, s);
  const T wa = power_offset(t, p, a), wb = power_offset(t, q, b), wc = power_offset(t, r, c),
          wd = power_offset(t, s, d);
  if constexpr (std::is_same_v<T, double>) {
    const auto most = [](double i, double j, double k, double l) {
      return std::max({std::abs(i), std::abs(j), std::abs(k), std::abs(l)});
    };
    const double x = most(a.x, b.x, c.x, d.x), y = most(a.y, b.y, c.y, d.y),
                 z = most(a.z, b.z, c.z, d.z),
                 radius = std::max(most(p.radius, q.radius, r.radius, s.radius), t.radius);
    *magnitude = 24 * x * y * z * (x * x + y * y + z * z + radius * radius);
  }
  const T ab = a.x * b.y - b.x * a.y, ac = a.x * c.y - c.x * a.y, ad = a.x * d.y - d.x * a.y,
          bc = b.x * c.y - c.x * b.y, bd = b.x * d.y - d.x * b.y, cd = c.x * d.y - d.x * c.y;
  const T abc = ab * c.z - ac * b.z + bc * a.z, abd = ab * d.z - ad * b.z + bd * a.z,
          acd = ac * d.z - ad * c.z + cd * a.z, bcd = bc * d.z - bd * c.z + cd * b.z;
  return bcd * wa - acd * wb + abd * wc - abc * wd;
}

// pow_d - pow_a at the centre of a, which is w_d.
template <class T>
T vertex_side_value(const Sphere& a, const Sphere& d, double* magnitude) {
  const Vector<T> ad = from_to<T>(a, d);
  if constexpr (std::is_same_v<T, double>) {
    const double radius = std::max(a.radius, d.radius);
    *magnitude = dot(ad, ad) + radius * radius;
  }
  return power_offset(a, d, ad);
}

// The size of edge ab, |x|² - r_a² with x = w_b ab / (2 |ab|²), times the positive factor 4 |ab|²,
// which is w_b² - 4 |ab|² r_a².
template <class T>
T edge_size_value(const Sphere& a, const Sphere& b, double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b);
  const T w = power_offset(a, b, ab);
  if constexpr (std::is_same_v<T, double>) {
    const double s = dot(ab, ab), radius = std::max(a.radius, b.radius), r2 = radius * radius;
    *magnitude = (s + r2) * (s + r2) + 4 * s * r2;
  }
  return w * w - T(4) * dot(ab, ab) * squared_radius<T>(a);
}

// The size of triangle abc, |x|² - r_a² with x in the plane of the triangle, times 4 G. G > 0 is
// the Gram determinant |ab|² |ac|² - (ab·ac)² of ab and ac.
template <class T>
T triangle_size_value(const Sphere& a, const Sphere& b, const Sphere& c, double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c);
  const T bb = dot(ab, ab), cc = dot(ac, ac), bc = dot(ab, ac);
  const T wb = power_offset(a, b, ab), wc = power_offset(a, c, ac);
  if constexpr (std::is_same_v<T, double>) {
    const double s = std::max(bb, cc), radius = std::max({a.radius, b.radius, c.radius}),
                 w = s + radius * radius;
    *magnitude = 4 * w * w * s + 8 * s * s * radius * radius;
  }
  return wb * wb * cc - T(2) * wb * wc * bc + wc * wc * bb -
         T(4) * (bb * cc - bc * bc) * squared_radius<T>(a);
}

// The size of tetrahedron abcd, |x|² - r_a², times 4 D² with D = det(ab, ac, ad). By Cramer's rule
// x = n / (2 D) with n = w_b ac×ad + w_c ad×ab + w_d ab×ac.
template <class T>
T tetrahedron_size_value(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d,
                         double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c), ad = from_to<T>(a, d);
  const T wb = power_offset(a, b, ab), wc = power_offset(a, c, ac), wd = power_offset(a, d, ad);
  if constexpr (std::is_same_v<T, double>) {
    const double s = std::max({dot(ab, ab), dot(ac, ac), dot(ad, ad)}),
                 radius = std::max({a.radius, b.radius, c.radius, d.radius}),
                 w = s + radius * radius;
    *magnitude = 27 * s * s * w * w + 36 * s * s * s * radius * radius;
  }
  const Vector<T> cd = cross(ac, ad), db = cross(ad, ab), bc = cross(ab, ac);
  const T determinant = dot(ab, cd);
  const Vector<T> n{wb * cd.x + wc * db.x + wd * bc.x, wb * cd.y + wc * db.y + wd * bc.y,
                    wb * cd.z + wc * db.z + wd * bc.z};
  return dot(n, n) - T(4) * determinant * determinant * squared_radius<T>(a);
}

// |ab|² (pow_d(x) - pow_a(x)) = |ab|² (w_d - 2 ad·x), with the x of edge_size_value().
template <class T>
T edge_side_value(const Sphere& a, const Sphere& b, const Sphere& d, double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ad = from_to<T>(a, d);
  if constexpr (std::is_same_v<T, double>) {
    const double s = std::max(dot(ab, ab), dot(ad, ad)),
                 radius = std::max({a.radius, b.radius, d.radius});
    *magnitude = 2 * s * (s + radius * radius);
  }
  return power_offset(a, d, ad) * dot(ab, ab) - power_offset(a, b, ab) * dot(ab, ad);
}

// G (pow_d(x) - pow_a(x)) = G (w_d - 2 ad·x), with G and x of triangle_size_value().
template <class T>
T triangle_side_value(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d,
                      double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c), ad = from_to<T>(a, d);
  const T bb = dot(ab, ab), cc = dot(ac, ac), bc = dot(ab, ac), bd = dot(ab, ad), cd = dot(ac, ad);
  const T wb = power_offset(a, b, ab), wc = power_offset(a, c, ac), wd = power_offset(a, d, ad);
  if constexpr (std::is_same_v<T, double>) {
    const double s = std::max({bb, cc, dot(ad, ad)}),
                 radius = std::max({a.radius, b.radius, c.radius, d.radius});
    *magnitude = 6 * s * s * (s + radius * radius);
  }
  return wd * (bb * cc - bc * bc) - (wb * cc - wc * bc) * bd - (wc * bb - wb * bc) * cd;
}

// Returns the sign of a polynomial. `evaluate(T{}, &magnitude)` returns its value in the number
// type T; the first argument only names T. For double it sets `magnitude`, and the error of the
// value is at most `roundings` * kRoundoff * magnitude. If this bound is tiny, infinite or NaN, or
// if the value does not exceed it, the value in exact arithmetic decides.
template <class Evaluate>
Sign filtered_sign(double roundings, Evaluate evaluate) {
  double magnitude = 0;
  const double value = evaluate(double{}, &magnitude);
  const double bound = roundings * kRoundoff * magnitude;
  if (bound > kTinyBound && std::abs(value) > bound) {
    return value < 0 ? Sign::negative : Sign::positive;
  }
  const auto sign = CGAL::sign(evaluate(Exact{}, nullptr));
  return sign < 0 ? Sign::negative : (sign > 0 ? Sign::positive : Sign::zero);
}

}  // namespace

Sign orientation_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d) {
  return filtered_sign(16, [&]<class T>(const T&, double* magnitude) {
    return orientation_value<T>(a, b, c, d, magnitude);
  });
}

Sign power_side(const Sphere& p, const Sphere& q, const Sphere& r, const Sphere& s,
                const Sphere& t) {
  return filtered_sign(24, [&]<class T>(const T&, double* magnitude) {
    return power_side_value<T>(p, q, r, s, t, magnitude);
  });
}

// A lifted point that is raised lies above the hyperplane of the others. If it is one of the cell's
// four, its hyperplane rises with it on its own side of the facet opposite to it. The point that is
// raised most decides, unless it does not matter: that is, if the last ball's centre is in the
// plane of that facet. It cannot be in the planes of three facets, without being a vertex.
Sign conflict_side(const std::array<const Sphere*, 4>& cell, const Sphere& ball) {
  const Sign side = power_side(*cell[0], *cell[1], *cell[2], *cell[3], ball);
  if (side != Sign::zero) return side;
  const auto place = [](const Sphere& s) { return std::tie(s.center.x, s.center.y, s.center.z); };
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::ranges::sort(
      order, [&](std::size_t i, std::size_t j) { return place(*cell[i]) > place(*cell[j]); });
  for (const std::size_t k : order) {
    if (place(*cell[k]) <= place(ball)) break;
    std::array<const Sphere*, 4> four = cell;
    four[k] = &ball;
    const Sign orientation = orientation_sign(*four[0], *four[1], *four[2], *four[3]);
    if (orientation != Sign::zero) return orientation;
  }
  return Sign::negative;
}

Sign size_sign(const Sphere& a, const Sphere& b) {
  return filtered_sign(24, [&]<class T>(const T&, double* magnitude) {
    return edge_size_value<T>(a, b, magnitude);
  });
}

Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c) {
  return filtered_sign(32, [&]<class T>(const T&, double* magnitude) {
    return triangle_size_value<T>(a, b, c, magnitude);
  });
}

Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d) {
  return filtered_sign(64, [&]<class T>(const T&, double* magnitude) {
    return tetrahedron_size_value<T>(a, b, c, d, magnitude);
  });
}

Sign side_sign(const Sphere& a, const Sphere& d) {
  return filtered_sign(12, [&]<class T>(const T&, double* magnitude) {
    return vertex_side_value<T>(a, d, magnitude);
  });
}

Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& d) {
  return filtered_sign(24, [&]<class T>(const T&, double* magnitude) {
    return edge_side_value<T>(a, b, d, magnitude);
  });
}

Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d) {
  return filtered_sign(32, [&]<class T>(const T&, double* magnitude) {
    return triangle_side_value<T>(a, b, c, d, magnitude);
  });
}

bool plane_between_centers(const Sphere& a, const Sphere& b) {
  return side_sign(a, b) == Sign::positive && side_sign(b, a) == Sign::positive;
}

}  // namespace vdwmesh
