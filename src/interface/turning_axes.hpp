// Axes at a place that turn with the atoms around it, so that samples that lie in them do. For the
// library's own use.
#pragma once

#include <array>
#include <span>

#include "core/vec3.hpp"
#include "interface/point_grid.hpp"

namespace vdwmesh {

// Three orthonormal vectors, right- or left-handed.
struct TurningAxes {
  std::array<Vec3d, 3> axis;

  Vec3d in_space(const Vec3d& v) const { return v.x * axis[0] + v.y * axis[1] + v.z * axis[2]; }
  // A unit vector at right angles to v, which has length 1.
  Vec3d across(const Vec3d& v) const;
  // Whether the vector, of length 1, goes against the first axis that is not about at right angles
  // to it: one of a vector and its negative does, wherever the axes point.
  bool opposes(const Vec3d& v) const;
};

// The axes come from sums over the atoms around, with weights that fall to 0 smoothly at several
// distances. They neither depend on the order of the atoms nor jump with their last digits, and
// mirrored atoms have mirrored axes. Where the atoms around are symmetric, all atoms decide. Of all
// atoms on one line, or in one plane, nothing says how to turn about the line, or which side is up:
// there samples lie in the file's axes, and results are equal only within their stated error.
class AxesSource {
 public:
  explicit AxesSource(std::span<const Vec3d> centers);

  TurningAxes at(const Vec3d& place) const;

 private:
  std::span<const Vec3d> centers_;
  PointGrid grid_;
};

}  // namespace vdwmesh
