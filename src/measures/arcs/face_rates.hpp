// By how much weighted sums of areas and volumes change with what two balls share: the formulas of
// derivatives, for host and device.
//
// Ball i and its neighbour j have the distance d and the axis n from i to j. The plane of their
// circle has the heights h over i and k over j; the circle has the exposed angle φ and T = ∫ arm
// dφ; the power face in the ball has the area F and M = ∫ place dF. If the ball at j moves by v and
// grows by s, the axis turns by v⊥ / d, and h grows by (k n·v - s r_j) / d. So
//   ∂A_i/∂x_j = (φ r_i k n - r_i T) / d      ∂A_i/∂r_j = -φ r_i r_j / d
//   ∂V_i/∂x_j = (F k n - M) / d              ∂V_i/∂r_j = -F r_j / d
//   ∂A_i/∂r_i = 2 A_i / r_i + Σ φ (r_i² / d - h)   ∂V_i/∂r_i = A_i + Σ F r_i / d
// A ball that moves by v changes as if all others moved by -v. Seen from j, the axis is -n and h
// and k change places, while φ, T, F and M are the same. So ball i alone has both ∂A_i/∂x_j and
// ∂A_j/∂x_i, and gathers what a gradient needs.
#pragma once

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "measures/arcs/arc_cap.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::arcs {

// Whether two spheres only touch: the squared distance is this near to the squared sum of the
// radii, so that rounding of either ball's cap would decide alone whether there is a circle.
VDWMESH_HD inline bool only_touch(const Sphere& ball, const Sphere& other) {
  constexpr double kContact = 1e-15;
  const Vec3d to = other.center - ball.center;
  const double sum = ball.radius + other.radius;
  return sum * sum - inner(to, to) <= kContact * sum * sum;
}

// The plane that two balls share, in Å.
struct SharedPlane {
  double inverse_distance;      // 1 / d
  double height, other_height;  // h, k
};
VDWMESH_HD inline SharedPlane shared_plane(const Sphere& ball, const Sphere& other,
                                           const Cap& cap) {
  const double distance = inner(cap.axis, other.center - ball.center), inverse = 1 / distance,
               power = (other.radius - ball.radius) * (ball.radius + other.radius);
  return {inverse, cap.cosine * ball.radius, 0.5 * (distance + power * inverse)};
}

// Weights of a ball in the two sums.
struct BallWeights {
  double area, volume;
};

// What a unit of φ n, T, φ, F n, M and F adds to the derivatives by a ball's centre and, for φ and
// F, by its radius.
struct FaceRates {
  double angle_along, arc, angle_radius;   // of Σ w A
  double area_along, moment, area_radius;  // of Σ u V
};
VDWMESH_HD inline FaceRates face_rates(double radius, double other_radius, const SharedPlane& plane,
                                       const BallWeights& own, const BallWeights& other) {
  const double inverse = plane.inverse_distance, reach = own.area * radius,
               other_reach = other.area * other_radius;
  const double apart = (own.volume - other.volume) * inverse;
  return {.angle_along = -inverse * (reach * plane.other_height + other_reach * plane.height),
          .arc = (reach - other_reach) * inverse,
          .angle_radius = own.area * (radius * radius * inverse - plane.height) -
                          other_reach * radius * inverse,
          .area_along = -inverse * (own.volume * plane.other_height + other.volume * plane.height),
          .moment = apart,
          .area_radius = radius * apart};
}

// What a ball's own area adds to its derivatives by the radius.
struct RadiusRates {
  double area, volume;
};
VDWMESH_HD inline RadiusRates radius_rates(double radius, double area, const BallWeights& own) {
  return {2 * own.area * (area / radius), own.volume * area};
}

}  // namespace vdwmesh::arcs
