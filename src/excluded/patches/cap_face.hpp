// The flat face of a cap: the part of the cap's disk that lies in other half-spaces.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh::excluded {

// The points w with normal · w <= height.
struct HalfSpace {
  Vec3d normal;
  double height;
};

// The area of the disk {axis · w = cosine, |w| <= 1} within the half-spaces. `axis` is a unit
// vector.
double face_area(const Vec3d& axis, double cosine, std::span<const HalfSpace> within);

}  // namespace vdwmesh::excluded
