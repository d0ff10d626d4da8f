// The cap that one ball covers on the sphere of another, and the order in which caps are used.
//
// Everything in vdwmesh::arcs looks at one ball at a time. Lengths are in units of that ball's
// radius and positions are relative to its centre, so the ball is the unit ball.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::arcs {

// A spherical cap: the points x of the unit sphere with dot(axis, x) > cosine. The same inequality
// describes the half-space beyond the radical plane of the two balls. The power cell of the ball is
// therefore what remains of space after the half-spaces of all its caps are removed.
struct Cap {
  Vec3d axis;     // unit, towards the other centre
  double cosine;  // of the cap's angle: signed distance of the radical plane, in (-1, 1)
};

// none: the other ball covers nothing of the sphere. cuts: it covers a cap. buries: it covers all.
enum class CapKind : std::uint8_t { none, cuts, buries };

// Scalar product in plain products. Without the compiler option -mfma a std::fma is a library call,
// which would be too slow in the inner loops of this folder.
VDWMESH_HD inline double inner(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// Two unit vectors that form an orthonormal basis with a given unit vector (T. Duff et al.,
// "Building an orthonormal basis, revisited", JCGT 6 (2017) 1).
struct AxisBasis {
  Vec3d first, second;
};
VDWMESH_HD inline AxisBasis frame_of(const Vec3d& axis) {
  const double sign = axis.z < 0 ? -1.0 : 1.0;
  const double a = -1 / (sign + axis.z);
  const double b = axis.x * axis.y * a;
  return {{1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x},
          {b, sign + axis.y * axis.y * a, -axis.y}};
}

// Below this the squared distance of two centres is not reliable: the squares of the coordinate
// differences may have lost digits to underflow.
inline constexpr double kLeastSquare = 1e-280;

// make_cap() for centres whose squared distance is below kLeastSquare, that is, closer than 1e-140.
// `to` is the vector from the centre of `ball` to the other one. It is scaled up before it is
// squared. Of two balls with different radii the larger one buries the smaller one, except if both
// radii are so small (below 1e-120) that they can differ by less than the distance.
VDWMESH_HD inline CapKind make_near_cap(const Sphere& ball, const Sphere& other, Vec3d to,
                                        Cap& cap) {
  const double r = ball.radius;
  if (to.x == 0 && to.y == 0 && to.z == 0) {
    return other.radius > r ? CapKind::buries : CapKind::none;
  }
  // A power of two makes the scaling exact. Components of at most 1e-140 become at most 4.2e40,
  // and the smallest double 5e-324 becomes 2e-143: no square of either leaves the range of double.
  constexpr double kScale = 0x1p600;
  to = kScale * to;
  const double distance = std::sqrt(inner(to, to));  // times kScale
  // cosine = (d² + r² - R²) / (2 d r), split into d / (2 r) and (r² - R²) / (2 r) / d.
  const double half_power = (r - other.radius) * (0.5 * (1 + other.radius / r));
  cap.cosine = distance / kScale / (2 * r) + half_power * kScale / distance;
  if (cap.cosine >= 1) return CapKind::none;
  if (cap.cosine <= -1) return CapKind::buries;
  cap.axis = (1 / distance) * to;
  return CapKind::cuts;
}

// Makes the cap that `other` covers on the sphere of `ball`; `cap` is valid for CapKind::cuts only.
// With r and R the radii and d the distance of the centres, the radical plane is at the distance
// (d² + r² - R²) / (2 d) from the centre of `ball`. If both centres are equal, the larger ball
// buries the smaller one; balls that are equal cover nothing here, and the caller decides between
// them.
VDWMESH_HD inline CapKind make_cap(const Sphere& ball, const Sphere& other, Cap& cap) {
  const Vec3d to = other.center - ball.center;
  const double squared = inner(to, to);
  const double r = ball.radius;
  const double sum = r + other.radius;
  if (squared >= sum * sum) return CapKind::none;
  if (squared < kLeastSquare) return make_near_cap(ball, other, to, cap);
  const double distance = std::sqrt(squared);
  // The product (r - R)(r + R) keeps the digits that r² - R² loses if the radii are nearly equal.
  const double power = squared + (r - other.radius) * sum;
  cap.cosine = power / (2 * distance * r);
  if (cap.cosine >= 1) return CapKind::none;
  if (cap.cosine <= -1) return CapKind::buries;
  cap.axis = (1 / distance) * to;
  return CapKind::cuts;
}

VDWMESH_HD inline bool same_cap(const Cap& a, const Cap& b) {
  return a.cosine == b.cosine && a.axis.x == b.axis.x && a.axis.y == b.axis.y &&
         a.axis.z == b.axis.z;
}

// The order in which caps cut the ball: the largest cap first, so that later caps find most of
// their circle covered already. Ties go by the axis. No two distinct caps are equal in this order,
// so the sorted sequence does not depend on the order in which the caps were found.
inline bool cuts_deeper(const Cap& a, const Cap& b) {
  if (a.cosine != b.cosine) return a.cosine < b.cosine;
  if (a.axis.x != b.axis.x) return a.axis.x < b.axis.x;
  if (a.axis.y != b.axis.y) return a.axis.y < b.axis.y;
  return a.axis.z < b.axis.z;
}

}  // namespace vdwmesh::arcs
