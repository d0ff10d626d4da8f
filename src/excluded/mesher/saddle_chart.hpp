// A conformal map of a saddle to a plane region, so that triangles keep their angles.
//
// Notation as in saddle_formulas.hpp. With the turn φ about the axis and the profile angle α,
// lengths are (ρ - p cos α) dφ along the arc and p dα across it. So (φ, s) with ds = p dα / (ρ - p
// cos α) is conformal, and the saddle is a rectangle. With t = tan(α/2) and D = (ρ - p) / (ρ + p),
// s is 2 p / (ρ + p) times ∫ dt / (t² + D).
//
// For half of a spindle the rectangle would have no end, because s is infinite in the cusp. Half of
// a spindle is mapped to a sector instead: exp(-κ s), with κ = sin θ, is the distance from the
// origin, κ φ is the angle, and the cusp is the origin. Distances from it are in closed form:
// sin((|α| - θ) / 2) / sin((|α| + θ) / 2).
//
// A waist, which has no points inside, is mapped to the plane of φ and α.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "creases/plane/plane_predicates.hpp"
#include "excluded/mesher/curve_complex.hpp"

namespace vdwmesh::excluded {

// A point of a torus, rad.
struct TorusPoint {
  double turn;     // φ from the start of the arc
  double profile;  // α
};

class SaddleChart {
 public:
  // `radial`: the direction from the circle's centre to the probe at φ = 0.
  SaddleChart(const RolledArc& arc, double probe_radius, const Vec3d& radial,
              const SaddlePart& part)
      : p_(probe_radius),
        rho_(arc.circle_radius),
        center_(arc.center),
        axis_(arc.axis),
        first_(radial),
        second_(cross(arc.axis, radial)),
        sector_(part.half < 2),
        waist_(part.waist),
        sign_(part.half == 1 ? -1 : 1),
        from_(part.from),
        to_(part.to),
        cusp_(profile_of(arc).cusp) {
    sine_ = std::sin(cusp_);
    half_tangent_ = std::tan(cusp_ / 2);
    start_ = std::tan(from_ / 2);
    gap_ = (rho_ - p_) / (rho_ + p_);
  }

  // The range of the profile angle.
  double from() const { return from_; }
  double to() const { return to_; }
  // The radius ρ - p cos α of the circle that a point of the profile sweeps.
  double girth(double profile) const { return rho_ - p_ * std::cos(profile); }

  PlanePoint project(const TorusPoint& q) const {
    if (waist_) return {q.turn, q.profile};
    if (!sector_) return {q.turn, 2 * p_ / (rho_ + p_) * integral(std::tan(q.profile / 2))};
    const double size = std::abs(q.profile);
    const double r = std::sin((size - cusp_) / 2) / std::sin((size + cusp_) / 2);
    return {r * std::cos(sine_ * q.turn), sign_ * r * std::sin(sine_ * q.turn)};
  }

  // The inverse of project(), up to rounding.
  TorusPoint lift(const PlanePoint& w) const {
    if (waist_) return {w.x, w.y};
    if (!sector_) return {w.x, 2 * std::atan(tangent(w.y * (rho_ + p_) / (2 * p_)))};
    const double r = std::hypot(w.x, w.y);
    double angle = std::atan2(sign_ * w.y, w.x);
    if (angle < 0) angle += 2 * std::numbers::pi;
    return {angle / sine_, -sign_ * 2 * std::atan(half_tangent_ * (1 + r) / (1 - r))};
  }

  Vec3d point(const TorusPoint& q) const {
    return center_ + girth(q.profile) * radial(q) + (p_ * std::sin(q.profile)) * axis_;
  }
  Vec3d normal(const TorusPoint& q) const {
    return std::cos(q.profile) * radial(q) - std::sin(q.profile) * axis_;
  }

 private:
  Vec3d radial(const TorusPoint& q) const {
    return std::cos(q.turn) * first_ + std::sin(q.turn) * second_;
  }

  // ∫ dt / (t² + D) from the start of the profile to t. All three forms have the limit (t - t₀) /
  // (t t₀) for D = 0.
  double integral(double t) const {
    const double apart = t - start_, across = gap_ + t * start_, root = std::sqrt(std::abs(gap_));
    if (gap_ > 0) return std::atan2(root * apart, across) / root;
    return gap_ < 0 ? std::atanh(root * apart / across) / root : apart / across;
  }

  // The inverse of integral().
  double tangent(double value) const {
    const double root = std::sqrt(std::abs(gap_)), x = root * value;
    double s = value, c = 1;
    if (gap_ > 0) s = std::sin(x) / root, c = std::cos(x);
    if (gap_ < 0) s = std::sinh(x) / root, c = std::cosh(x);
    return (start_ * c + s * gap_) / (c - s * start_);
  }

  double p_, rho_;
  Vec3d center_, axis_, first_, second_;
  bool sector_, waist_;
  double sign_;
  double from_, to_, cusp_, sine_, half_tangent_;
  double start_, gap_;  // t₀ and D
};

}  // namespace vdwmesh::excluded
