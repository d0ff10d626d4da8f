// The cap that ends at the cusps of a spindle: that of the probe beyond the gap in the circle on
// which the patch's own probe lies. For the library's own use, on the host and on a CUDA device.
#pragma once

#include <cmath>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {

// The angle of the gap between two arcs of a circle: counter-clockwise about the circle's axis if
// the gap is `behind_end` of the first arc, clockwise if it is before its start. `from` and `to`
// are unit vectors from the circle's centre to the ends of the first and the second arc there. A
// gap that rounding closes is not a whole turn.
VDWMESH_HD inline double gap_angle(const Vec3d& axis, const Vec3d& from, const Vec3d& to,
                                   bool behind_end) {
  const double sine = triple_product(axis, from, to);
  const double angle = std::atan2(behind_end ? sine : -sine, dot(from, to));
  constexpr double kClose = 1e-6, kTurn = 2 * 3.14159265358979323846;
  if (std::abs(angle) < kClose) return std::abs(angle);
  return angle < 0 ? angle + kTurn : angle;
}

// Covers the points w of a probe's unit sphere with axis · w > cosine.
struct GapCap {
  Vec3d axis;
  double cosine;
};

// The plane that bisects the probes on both sides of a gap contains the circle's axis and halves
// the gap's angle, so that the cap keeps its digits if the angle is small. `from` is the unit
// vector from the circle's centre to the patch's probe, `inward` the normal of the patch's side:
// at right angles to the axis and `from`, into the arc.
VDWMESH_HD inline GapCap gap_cap(double angle, const Vec3d& from, const Vec3d& inward,
                                 double circle_radius, double probe_radius) {
  const double half = angle / 2;
  return {unit(std::cos(half) * inward - std::sin(half) * from),
          circle_radius * std::sin(half) / probe_radius};
}

}  // namespace vdwmesh::excluded
