#include "arrangement/complex/power_predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "arrangement/complex/number_vector.hpp"

namespace vdwmesh {
namespace {

using Exact = CGAL::internal::Exact_ring_selector<double>::Type;

// Unit roundoff. The factors below count roundings along the longest path through each polynomial
// (difference of coordinates 1, scalar product 5, cofactor 5, determinant 9, power W 6) and are
// rounded up; the magnitudes are bounds of the sums of absolute values of all terms.
constexpr double kRoundoff = std::numeric_limits<double>::epsilon() / 2;
// Below it a bound may have lost its digits to underflow.
constexpr double kTinyBound = 1e-280;

using numbers::from_to;
using numbers::Vector;

template <class T>
T squared_radius(const Sphere& a) {
  return T(a.radius) * T(a.radius);
}

// pow_b(c_a) + r_a²: twice the scalar product of (c_b - c_a) with any orthogonal centre, from c_a.
template <class T>
T power_offset(const Sphere& a, const Sphere& b, const Vector<T>& ab) {
  return dot(ab, ab) + (T(a.radius) - T(b.radius)) * (T(a.radius) + T(b.radius));
}

template <class T>
T orientation_value(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d,
                    double* magnitude) {
  const Vector<T> ab = from_to<T>(a, b), ac = from_to<T>(a, c), ad = from_to<T>(a, d);
  if constexpr (std::is_same_v<T, double>) {
    *magnitude = 3 * std::sqrt(dot(ab, ab) * dot(ac, ac) * dot(ad, ad));
  }
  return dot(cross(ab, ac), ad);
}

template <class T>
T power_side_value(const Sphere& p, const Sphere& q, const Sphere& r, const Sphere& s,
                   const Sphere& t, double* magnitude) {
  const Vector<T> a = from_to<T>(t, p), b = from_to<T>(t, q), c = from_to<T>(t, r),
                  d = from_to<T>(t, s);
  const T wa = power_offset(t, p, a), wb = power_offset(t, q, b), wc = power_offset(t, r, c),
          wd = power_offset(t, s, d);
  if constexpr (std::is_same_v<T, double>) {
    const auto largest = [](double e, double f, double g, double h) {
      return std::max({std::abs(e), std::abs(f), std::abs(g), std::abs(h)});
    };
    const double x = largest(a.x, b.x, c.x, d.x), y = largest(a.y, b.y, c.y, d.y),
                 z = largest(a.z, b.z, c.z, d.z),
                 radius = std::max(largest(p.radius, q.radius, r.radius, s.radius), t.radius);
    *magnitude = 24 * x * y * z * (x * x + y * y + z * z + radius * radius);
  }
  const T ab = a.x * b.y - b.x * a.y, ac = a.x * c.y - c.x * a.y, ad = a.x * d.y - d.x * a.y,
          bc = b.x * c.y - c.x * b.y, bd = b.x * d.y - d.x * b.y, cd = c.x * d.y - d.x * c.y;
  const T abc = ab * c.z - ac * b.z + bc * a.z, abd = ab * d.z - ad * b.z + bd * a.z,
          acd = ac * d.z - ad * c.z + cd * a.z, bcd = bc * d.z - bd * c.z + cd * b.z;
  return bcd * wa - acd * wb + abd * wc - abc * wd;
}

template <class T>
T vertex_side_value(const Sphere& a, const Sphere& d, double* magnitude) {
  const Vector<T> ad = from_to<T>(a, d);
  if constexpr (std::is_same_v<T, double>) {
    const double radius = std::max(a.radius, d.radius);
    *magnitude = dot(ad, ad) + radius * radius;
  }
  return power_offset(a, d, ad);
}

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

// `evaluate(T{}, magnitude)` is the polynomial in T; its error in double is at most
// `roundings` * kRoundoff * magnitude.
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
