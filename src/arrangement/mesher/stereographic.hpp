// The unit sphere less one point, its pole, as a plane. Circles stay circles or become lines.
#pragma once

#include "arrangement/directions.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

struct PlanePoint {
  double x, y;
};

class Stereographic {
 public:
  explicit Stereographic(const Vec3d& pole)
      : pole_(pole), first_(any_orthogonal(pole)), second_(cross(first_, pole)) {}

  const Vec3d& pole() const { return pole_; }

  // Not finite for the pole.
  PlanePoint project(const Vec3d& u) const {
    const double w = 2 / squared_norm(u - pole_);
    return {w * dot(u, first_), w * dot(u, second_)};
  }

  Vec3d lift(const PlanePoint& p) const {
    return unit(2.0 * (p.x * first_ + p.y * second_) + (p.x * p.x + p.y * p.y - 1) * pole_);
  }

 private:
  Vec3d pole_, first_, second_;  // first × second = -pole
};

}  // namespace vdwmesh
