// The derivatives by one ball, from the faces that it shares. For the library's own use.
#pragma once

#include <cmath>
#include <span>

#include "core/errors.hpp"
#include "measures/arcs/face_rates.hpp"
#include "measures/arcs/shared_face.hpp"
#include "measures/union_gradients.hpp"

namespace vdwmesh {

// `own` are the ball's weights, weights_of(id) those of another one.
template <class Weights>
BallGradient ball_gradient(const Sphere& ball, double area, std::span<const SharedFace> faces,
                           const arcs::BallWeights& own, const Weights& weights_of) {
  BallGradient g{};
  for (const SharedFace& f : faces) {
    const arcs::FaceRates rates =
        arcs::face_rates(ball.radius, f.other_radius, f.plane, own, weights_of(f.other));
    g.area_center = g.area_center + (f.angle * rates.angle_along) * f.axis + rates.arc * f.arc;
    g.area_radius += f.angle * rates.angle_radius;
    g.volume_center =
        g.volume_center + (f.area * rates.area_along) * f.axis + rates.moment * f.moment;
    g.volume_radius += f.area * rates.area_radius;
  }
  const arcs::RadiusRates growth = arcs::radius_rates(ball.radius, area, own);
  g.area_radius += growth.area;
  g.volume_radius += growth.volume;
  return g;
}

inline bool is_finite(const BallGradient& g) {
  const auto all = [](const Vec3d& v, double s) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(s);
  };
  return all(g.area_center, g.area_radius) && all(g.volume_center, g.volume_radius);
}

// Throws InvalidInput unless it is.
void require_finite_derivatives(bool finite);

// Throws InvalidInput unless there are no weights or a finite one for each sphere.
void check_weights(std::span<const double> areas, std::span<const double> volumes,
                   std::size_t spheres);

}  // namespace vdwmesh
