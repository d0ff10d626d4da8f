// The exposed part of one sphere of a union of balls, for host and device.
//
// A point of a sphere is exposed if no other ball covers it. The patch of a sphere is its exposed
// part; it lists the caps that other balls cover and the corners on its border.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "measures/arcs/arc_cap.hpp"
#include "spheres/list_place.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// A point of a sphere counts as covered only if it lies beyond the radical plane of another ball by
// more than this, in units of the sphere's radius. Without a tolerance, rounding could make a
// corner seem covered by a further ball whose sphere passes through the same point. The error of a
// corner is about 10 roundings (1e-15) divided by the product of the squared sines of the angles at
// which its planes meet. The tolerance suffices if one of these angles is as small as 0.2°, where
// sin² = 1e-5. Its price: distances are measured to a boundary whose radii are changed by about
// this relative amount.
inline constexpr double kExposureTolerance = 1e-10;

inline constexpr ListPlace kNoPlace{0xffffffffu};  // stands for no sphere of a list

// The part of a sphere that one other ball covers.
struct Cover {
  arcs::Cap cap;    // relative to the sphere, in units of its radius
  ListPlace place;  // of the other ball
};

// A corner: an exposed point where the sphere meets two others. All three patches list it.
struct SphereCorner {
  Vec3d position;  // relative to the centre of the sphere, in units of its radius
  bool first;      // whether the sphere of this patch has the smallest list place of the three
};

// The exposed part of one sphere.
struct Patch {
  Sphere ball;
  ListPlace place;
  // The circle of a cover is the border of its cap. Exactly the covers [0, circles) have exposed
  // arcs on their circles.
  std::uint32_t circles;
  std::uint32_t cover_count, corner_count;
  const Cover* covers;  // all caps on the sphere, without caps within others
  const SphereCorner* corners;
};

inline constexpr std::uint32_t kNoCover = 0xffffffffu;

// Returns whether none of `count` covers contains the direction, a unit vector from the centre of
// the sphere. The cover with the index `skip` is ignored. Callers name the cover on whose circle
// the point lies, because there rounding alone would decide.
VDWMESH_HD inline bool is_exposed(const Cover* covers, std::uint32_t count, const Vec3d& direction,
                                  std::uint32_t skip = kNoCover) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const arcs::Cap& cap = covers[i].cap;
    if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && i != skip)
      return false;
  }
  return true;
}
VDWMESH_HD inline bool is_exposed(const Patch& patch, const Vec3d& direction,
                                  std::uint32_t skip = kNoCover) {
  return is_exposed(patch.covers, patch.cover_count, direction, skip);
}

}  // namespace vdwmesh
