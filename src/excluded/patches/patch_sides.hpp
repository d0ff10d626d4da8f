// The sides of a concave patch, which come from the arcs that end at its probe, and the caps that
// other probes cut off it. For the library's own use, on the host and on a CUDA device.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "complex/placed_balls.hpp"
#include "core/no_index.hpp"
#include "excluded/patches/saddle_formulas.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {

enum class ArcEnd : std::uint8_t { start, end };

// A side of the polygon of a probe, directed so that the patch is on its left seen from outside the
// sphere.
struct PatchSide {
  std::uint32_t arc;
  ArcEnd end;                         // the end of the arc at which the probe is
  std::array<std::uint32_t, 2> atom;  // from, to
  Vec3d inward;                       // unit normal of the side's plane
  std::array<Vec3d, 2> contact;       // unit vectors to the atoms
  std::array<Vec3d, 2> cusp;          // if a spindle: unit vectors to the cusps near the atoms
  std::array<double, 2> angle;        // from the atoms to the radical plane, or to the cusps
  bool spindle;
  std::uint32_t gap;  // if a spindle: the cap that ends at the cusps
  double turning;     // exterior angle where the side ends
};

// Covers the points w of the unit sphere with axis · w > cosine. 0 < cosine < 1.
struct PatchCap {
  Vec3d axis;
  double cosine;
  std::uint32_t probe;
};

// The side that the arc of balls a and b has at one of its ends, without `gap` and `turning`. The
// probe has the radius p.
VDWMESH_HD inline PatchSide patch_side(const ArcShape& shape, std::uint32_t arc, ArcEnd end,
                                       std::uint32_t a, std::uint32_t b, double p) {
  const Profile profile = profile_of(shape);
  const Vec3d& radial = shape.radial[static_cast<std::size_t>(end)];
  const Vec3d inwards = -shape.circle_radius * radial, tangent = cross(shape.axis, radial);
  PatchSide side{};
  side.arc = arc;
  side.end = end;
  side.spindle = shape.spindle;
  side.gap = kNoIndex;
  side.inward = end == ArcEnd::end ? tangent : -1.0 * tangent;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t place = end == ArcEnd::end ? k : 1 - k;  // of ball k: from 0 to 1
    const double sign = k == 0 ? -1 : 1;
    side.atom[place] = k == 0 ? a : b;
    side.contact[place] = unit(inwards + (sign * shape.height[k]) * shape.axis);
    side.cusp[place] = (1 / p) * (inwards + (sign * shape.cusp_height) * shape.axis);
    side.angle[place] = sign * profile.end[k] - profile.cusp;
  }
  return side;
}

// The angle of the gap between two arcs of a circle: counter-clockwise about the circle's axis if
// the gap is `behind_end` of the first arc, clockwise if it is before its start. `from` and `to`
// are unit vectors from the circle's centre to the ends of the first and the second arc there. A
// gap that rounding closes is not a whole turn.
VDWMESH_HD inline double gap_angle(const Vec3d& axis, const Vec3d& from, const Vec3d& to,
                                   bool behind_end) {
  const double sine = triple_product(axis, from, to);
  const double angle = std::atan2(behind_end ? sine : -sine, dot(from, to));
  constexpr double kClose = 1e-6;
  if (std::abs(angle) < kClose) return std::abs(angle);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

// The cap that ends at the cusps of a spindle: that of the probe beyond the gap in the circle on
// which the patch's own probe lies. The plane that bisects the probes on both sides of a gap
// contains the circle's axis and halves the gap's angle, so that the cap keeps its digits if the
// angle is small. `from` is the unit vector from the circle's centre to the patch's probe, `inward`
// the normal of the patch's side: at right angles to the axis and `from`, into the arc.
VDWMESH_HD inline PatchCap gap_cap(double angle, const Vec3d& from, const Vec3d& inward,
                                   double circle_radius, double probe_radius, std::uint32_t probe) {
  const double half = angle / 2;
  return {unit(std::cos(half) * inward - std::sin(half) * from),
          circle_radius * std::sin(half) / probe_radius, probe};
}

}  // namespace vdwmesh::excluded
