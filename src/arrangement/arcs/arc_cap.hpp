// What one ball takes away from the sphere of another: a cap. All lengths are in units of the
// sphere's own radius, all positions relative to its centre.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::arcs {

// The points x of the unit sphere with dot(axis, x) > cosine; equally, the half-space beyond the
// radical plane of the two balls, so the ball's power cell is what all its caps leave of space.
struct Cap {
  Vec3d axis;     // unit, towards the other centre
  double cosine;  // signed distance of the radical plane, in (-1, 1)
};

enum class CapKind : std::uint8_t { none, cuts, buries };

// Plain products: without -mfma a std::fma is a library call, and these are the inner loops.
VDWMESH_HD inline double inner(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

// A smaller square of a distance may have lost digits to underflow.
inline constexpr double kLeastSquare = 1e-280;

// The cap of a ball whose centre is next to nothing away: of balls that are not equal the larger
// buries the smaller, unless both are next to nothing.
VDWMESH_HD inline CapKind make_near_cap(const Sphere& ball, const Sphere& other, Vec3d to,
                                        Cap& cap) {
  const double r = ball.radius;
  if (to.x == 0 && to.y == 0 && to.z == 0) {
    return other.radius > r ? CapKind::buries : CapKind::none;
  }
  constexpr double kScale = 0x1p600;
  to = kScale * to;
  const double distance = std::sqrt(inner(to, to));  // scaled
  const double half_power = (r - other.radius) * (0.5 * (1 + other.radius / r));
  cap.cosine = distance / kScale / (2 * r) + half_power * kScale / distance;
  if (cap.cosine >= 1) return CapKind::none;
  if (cap.cosine <= -1) return CapKind::buries;
  cap.axis = (1 / distance) * to;
  return CapKind::cuts;
}

// Concentric balls: the larger buries the smaller; equal ones are the caller's to order.
VDWMESH_HD inline CapKind make_cap(const Sphere& ball, const Sphere& other, Cap& cap) {
  const Vec3d to = other.center - ball.center;
  const double squared = inner(to, to);
  const double r = ball.radius;
  const double sum = r + other.radius;
  if (squared >= sum * sum) return CapKind::none;
  if (squared < kLeastSquare) return make_near_cap(ball, other, to, cap);
  const double distance = std::sqrt(squared);
  // (r - R)(r + R) keeps the digits of nearly equal radii.
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

// The deepest cuts first, so that later caps find most of their circle already covered. A strict
// order of distinct caps: the result does not depend on the order they came in.
VDWMESH_HD inline bool cuts_deeper(const Cap& a, const Cap& b) {
  if (a.cosine != b.cosine) return a.cosine < b.cosine;
  if (a.axis.x != b.axis.x) return a.axis.x < b.axis.x;
  if (a.axis.y != b.axis.y) return a.axis.y < b.axis.y;
  return a.axis.z < b.axis.z;
}

// Shell sort, in place.
VDWMESH_HD inline void sort_caps(Cap* caps, std::uint32_t count) {
  std::uint32_t gap = 1;
  while (gap < count / 3) gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3) {
    for (std::uint32_t i = gap; i < count; ++i) {
      const Cap cap = caps[i];
      std::uint32_t j = i;
      for (; j >= gap && cuts_deeper(cap, caps[j - gap]); j -= gap) caps[j] = caps[j - gap];
      caps[j] = cap;
    }
  }
}

}  // namespace vdwmesh::arcs
