// Whether two triangles of a mesh intersect, decided by the signs of tetrahedron volumes in double
// where rounding cannot have changed them; where it might have, the answer is `unsure`, and
// facet_pair_exact.hpp decides.
//
// What counts as an intersection depends on how many vertices the two triangles share by index: a
// shared vertex or edge is part of every mesh and does not count; anything beyond it does. Two
// triangles with the same three vertices coincide, which counts.
//
// The error bound. With u = b - a, v = c - a, w = d - a the volume of the tetrahedron (a, b, c, d)
// is a sixth of D = w · n, n = u × v. Let ε = 2^-53. Each of the six products w_i u_j v_k of which
// D is the sum goes through at most eight roundings: three differences, two products, the
// difference of the component of n, two sums. So the computed D differs from the exact one by at
// most
// ((1 + ε)^8 - 1) P with P = Σ |w_i| (|u_j v_k| + |u_k v_j|). The computed P has at most nine
// roundings, all of positive numbers, so it is at least (1 - ε)^9 times the exact one; 16 ε times
// the computed P is therefore more than the error. (J. R. Shewchuk, Discrete Comput. Geom. 18
// (1997) 305, derives a tighter bound in the same way.)
//
// Underflow adds at most 2^-1075 to each product; sums and differences never underflow inexactly.
// kFloor, added to every component of m = (|u_j v_k| + |u_k v_j|), makes the bound larger by
// 2^-1049 |w|, which covers the two products of n. kTiny covers the products with w and with 16 ε.
//
// Overflow: rounding is monotone, so the computed |D| is at most the computed P. If D is infinite,
// so are P and the bound; then, and if D is not a number, no comparison with the bound holds.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "core/vec3.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// A triangle with what its plane needs.
struct Facet {
  Triangle vertex;              // indices
  std::array<Vec3d, 3> corner;  // a, b, c
  Vec3d normal;                 // n = (b - a) × (c - a)
  Vec3d magnitude;              // m; component i is |u_j v_k| + |u_k v_j| + kFloor
};

inline constexpr double kFloor = 0x1p-1000;
inline constexpr double kTiny = 0x1p-1060;

// Sets normal and magnitude from the corners.
inline void set_plane(Facet& f) {
  const Vec3d u = f.corner[1] - f.corner[0], v = f.corner[2] - f.corner[0];
  const double x1 = u.y * v.z, x2 = u.z * v.y;
  const double y1 = u.z * v.x, y2 = u.x * v.z;
  const double z1 = u.x * v.y, z2 = u.y * v.x;
  f.normal = {x1 - x2, y1 - y2, z1 - z2};
  f.magnitude = {std::abs(x1) + std::abs(x2) + kFloor, std::abs(y1) + std::abs(y2) + kFloor,
                 std::abs(z1) + std::abs(z2) + kFloor};
}

inline Facet make_facet(const Triangle& vertex, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  Facet f{vertex, {a, b, c}, {}, {}};
  set_plane(f);
  return f;
}

// Whether the triangle has an area for certain. A component of the normal goes through four
// roundings, so 8 ε m is more than its error, by the argument above.
inline bool has_area(const Facet& f) {
  constexpr double kBound = 0x1p-50;
  return std::abs(f.normal.x) > kBound * f.magnitude.x ||
         std::abs(f.normal.y) > kBound * f.magnitude.y ||
         std::abs(f.normal.z) > kBound * f.magnitude.z;
}

inline constexpr double kSideBound = 0x1p-49;  // 16 ε

// The side of the facet's plane on which d lies: 1 if a, b, c run counter-clockwise as seen from d,
// -1 on the other side, 0 if that is not certain or d lies in the plane.
inline int side_of(const Facet& f, const Vec3d& d) {
  const Vec3d w = d - f.corner[0];
  const double volume = w.x * f.normal.x + w.y * f.normal.y + w.z * f.normal.z;
  const double bound = kSideBound * (std::abs(w.x) * f.magnitude.x + std::abs(w.y) * f.magnitude.y +
                                     std::abs(w.z) * f.magnitude.z) +
                       kTiny;
  return (volume > bound) - (volume < -bound);
}

enum class Meeting : std::uint8_t { apart, intersect, unsure };

// Whether the straight line through p and q meets the facet. The facet's edges pass the line on one
// side each, and the line meets the facet if it is the same side for all three.
inline Meeting line_meets(const Vec3d& p, const Vec3d& q, const Facet& f) {
  int passes[3];
  for (std::size_t k = 0; k < 3; ++k) {
    passes[k] = side_of(make_facet({}, p, q, f.corner[k]), f.corner[k == 2 ? 0 : k + 1]);
    if (k > 0 && passes[k] * passes[0] < 0) return Meeting::apart;
  }
  if (passes[1] * passes[2] < 0) return Meeting::apart;
  return passes[0] * passes[1] * passes[2] == 0 ? Meeting::unsure : Meeting::intersect;
}

// The corners of two facets in an order in which the shared vertices come first, pair by pair.
struct Matching {
  std::uint8_t shared = 0;
  std::array<std::uint8_t, 3> a{0, 1, 2}, b{0, 1, 2};
};

// The matching for each set of equal vertices: bit 3 i + j says that vertex i of a is vertex j of
// b.
inline constexpr auto kMatchings = [] {
  std::array<Matching, 512> all{};
  for (unsigned equal = 0; equal < 512; ++equal) {
    Matching& m = all[equal];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = m.shared; j < 3; ++j) {
        if ((equal >> (3 * m.a[i] + m.b[j]) & 1) == 0) continue;
        std::swap(m.a[i], m.a[m.shared]);
        std::swap(m.b[j], m.b[m.shared]);
        ++m.shared;
        break;
      }
    }
  }
  return all;
}();

inline const Matching& match(const Triangle& a, const Triangle& b) {
  unsigned equal = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) equal |= unsigned{a[i] == b[j]} << (3 * i + j);
  }
  return kMatchings[equal];
}

// The sides of a plane on which the corners of a facet from `first` on lie, in the order of a
// matching. Corners before `first` lie in the plane.
template <std::size_t first>
struct CornerSides {
  std::array<int, 3> side{};
  CornerSides(const Facet& plane, const Facet& f, const std::array<std::uint8_t, 3>& order) {
    for (std::size_t k = first; k < 3; ++k) side[k] = side_of(plane, f.corner[order[k]]);
  }
  bool certain() const {
    bool all = true;
    for (std::size_t k = first; k < 3; ++k) all &= side[k] != 0;
    return all;
  }
  bool one_side() const {
    bool all = side[2] != 0;
    for (std::size_t k = first; k < 2; ++k) all &= side[k] == side[2];
    return all;
  }
};

// Whether an edge of f between corners from `first` on meets the facet `other`, whose plane has
// these corners at `sides`, all certain. Only an edge with ends on different sides can.
template <std::size_t first>
Meeting edges_meet(const Facet& f, const std::array<std::uint8_t, 3>& order,
                   const CornerSides<first>& sides, const Facet& other) {
  Meeting result = Meeting::apart;
  for (std::size_t i = first; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 3; ++j) {
      if (sides.side[i] == sides.side[j]) continue;
      const Meeting edge = line_meets(f.corner[order[i]], f.corner[order[j]], other);
      if (edge == Meeting::intersect) return edge;
      if (edge == Meeting::unsure) result = edge;
    }
  }
  return result;
}

// Whether two facets that share no vertex (first = 0) or the first one of the matching (first = 1)
// intersect elsewhere. If the unshared corners of one lie strictly on one side of the other's
// plane, that facet meets the plane in the shared vertex or nowhere. Else, with no corner in the
// other's plane, the facets meet the common line of their planes in an interval each. If the
// intervals have a point in common beside a shared vertex, they have one that is an end of an
// interval, thus a point of an edge of one facet in the other facet; and not of an edge at the
// shared vertex, which meets the other's plane only there.
template <std::size_t first>
Meeting meeting_beside(const Facet& a, const Facet& b, const Matching& m) {
  const CornerSides<first> of_b(a, b, m.b);
  if (of_b.one_side()) return Meeting::apart;
  const CornerSides<first> of_a(b, a, m.a);
  if (of_a.one_side()) return Meeting::apart;
  if (!of_a.certain() || !of_b.certain()) return Meeting::unsure;
  const Meeting by_b = edges_meet(b, m.b, of_b, a);
  if (by_b == Meeting::intersect) return by_b;
  const Meeting by_a = edges_meet(a, m.a, of_a, b);
  return by_a == Meeting::apart ? by_b : by_a;
}

// Whether two facets intersect beyond their shared vertices. Precondition: both have an area. Those
// with a common edge overlap only if they lie in one plane.
inline Meeting meeting(const Facet& a, const Facet& b, const Matching& m) {
  switch (m.shared) {
    case 0:
      return meeting_beside<0>(a, b, m);
    case 1:
      return meeting_beside<1>(a, b, m);
    case 2:
      return side_of(a, b.corner[m.b[2]]) != 0 ? Meeting::apart : Meeting::unsure;
    default:
      return Meeting::intersect;
  }
}

}  // namespace vdwmesh
