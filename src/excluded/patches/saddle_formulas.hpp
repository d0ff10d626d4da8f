// Closed forms of a saddle: the inner side of the torus that a probe sweeps along an arc.
//
// Notation, for the arc's circle with radius ρ, its centre A and its axis u: the probe is at
// x = A + ρ e(φ). A point of the saddle is q = A + (ρ - p cos α) e(φ) + p sin α u, its outward
// normal cos α e - sin α u, its area element p (ρ - p cos α) dα dφ. The profile angle α is 0 in the
// radical plane, α₀ = atan2(-t_a, ρ) at atom a and α₁ = atan2(t_b, ρ) at atom b; t are the plane's
// heights. A saddle is a spindle if ρ < p and the plane lies between the centres: its profile then
// crosses the axis at ±θ, cos θ = ρ/p, and the part between is no surface.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "core/vec3.hpp"

namespace vdwmesh::excluded {

struct Profile {
  std::array<double, 2> end;  // α₀, α₁
  bool spindle;
  double cusp;  // θ of a spindle, else 0
};

// An exposed arc of the circle of two grown balls a and b, counter-clockwise about the axis from a
// to b.
struct ArcShape {
  Vec3d axis;
  double angle, circle_radius;
  std::array<double, 2> height;  // signed, of the circle's plane over the centres of a and b
  std::array<Vec3d, 2> radial;   // unit vectors from the circle's centre to the ends; 0 of a ring
  double cusp_height;  // of a spindle: distance of its cusps from the circle's plane; else 0
  bool spindle;        // the saddle is cut by its own axis
};

// The part of a saddle between two profile angles.
struct SaddleMeasures {
  double area;
  Vec3d vector;  // integral of the outward normal
  double flux;   // integral of (q - A) · n / 3
  double layer;  // volume between the accessible surface and the saddle
  double bend;   // integral of the Gaussian curvature
};

VDWMESH_HD inline Profile profile_of(const ArcShape& arc) {
  const double rho = arc.circle_radius;
  return {{std::atan2(-arc.height[0], rho), std::atan2(arc.height[1], rho)},
          arc.spindle,
          std::atan2(arc.cusp_height, rho)};
}

// The integral of e(φ) along the arc.
VDWMESH_HD inline Vec3d radial_integral(const ArcShape& arc) {
  return cross(arc.axis, arc.radial[0] - arc.radial[1]);
}

// ∫ n dω of what the arc adds to the contact piece of ball `side`, which has the radius r.
VDWMESH_HD inline Vec3d contact_vector(const ArcShape& arc, std::size_t side, double r) {
  const double rho = arc.circle_radius, turn = (side == 0 ? -1 : 1) * rho * rho * arc.angle;
  return (0.5 / (r * r)) * (turn * arc.axis + (arc.height[side] * rho) * radial_integral(arc));
}

VDWMESH_HD inline SaddleMeasures measure_profile(const ArcShape& arc, double p, double from,
                                                 double to) {
  const double rho = arc.circle_radius, angle = arc.angle;
  const double s0 = std::sin(from), s1 = std::sin(to), c0 = std::cos(from), c1 = std::cos(to);
  const double one = to - from, cosine = s1 - s0, sine = c0 - c1;
  const double cosine2 = (one + s1 * c1 - s0 * c0) / 2, sine_cosine = (s1 * s1 - s0 * s0) / 2;
  SaddleMeasures m{};
  m.area = angle * p * (rho * one - p * cosine);
  m.vector = p * ((rho * cosine - p * cosine2) * radial_integral(arc) -
                  (angle * (rho * sine - p * sine_cosine)) * arc.axis);
  const double bulk = (p * p + rho * rho) * cosine - rho * p * (one + cosine2);
  m.flux = angle * p * bulk / 3;
  m.layer = angle * p * p * (rho * one / 2 - p * cosine / 3);
  m.bend = -angle * cosine;
  return m;
}

// The part of the saddle on one side of the radical plane, 0 or 1, which belongs to the atom there.
// One of the two parts is empty if the plane does not cut the saddle. Under a spindle the layer
// ends at the axis.
VDWMESH_HD inline SaddleMeasures measure_saddle(const ArcShape& arc, double p,
                                                const Profile& profile, std::size_t side) {
  const double cusp = profile.cusp, rho = arc.circle_radius;
  const double from = side == 0 || profile.end[0] > cusp ? profile.end[0] : cusp;
  const double to = side == 1 || profile.end[1] < -cusp ? profile.end[1] : -cusp;
  if (!(from < to)) return {};
  SaddleMeasures m = measure_profile(arc, p, from, to);
  if (profile.spindle) m.layer += arc.angle * rho * rho * rho / 6 * std::tan(cusp);
  return m;
}

}  // namespace vdwmesh::excluded
