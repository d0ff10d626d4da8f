// Stereographic projection of the unit sphere, less one point (the pole), to a plane. It is
// conformal and maps circles to circles or lines. So the empty-circle property of a Delaunay
// triangulation means the same in the plane and on the sphere.
//
// The plane's axes are chosen so that orientation is kept: a triangle that is counter-clockwise on
// the sphere, seen from outside, is counter-clockwise in the plane.
// For host and device.
#pragma once

#include "core/vec3.hpp"
#include "creases/plane/plane_predicates.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {

class Stereographic {
 public:
  // The pole must have unit length.
  VDWMESH_HD explicit Stereographic(const Vec3d& pole)
      : pole_(pole), first_(any_orthogonal(pole)), second_(cross(first_, pole)) {}

  VDWMESH_HD const Vec3d& pole() const { return pole_; }

  // The image of a unit vector; not finite for the pole itself. The factor 2 / |u - pole|² equals
  // the usual 1 / (1 - u · pole), without its cancellation near the pole.
  VDWMESH_HD PlanePoint project(const Vec3d& u) const {
    const double w = 2 / squared_norm(u - pole_);
    return {w * dot(u, first_), w * dot(u, second_)};
  }

  // The inverse of project(): the unit vector whose image is p, up to rounding.
  VDWMESH_HD Vec3d lift(const PlanePoint& p) const {
    return unit(2.0 * (p.x * first_ + p.y * second_) + (p.x * p.x + p.y * p.y - 1) * pole_);
  }

 private:
  Vec3d pole_, first_, second_;  // orthonormal; first × second = -pole
};

}  // namespace vdwmesh
