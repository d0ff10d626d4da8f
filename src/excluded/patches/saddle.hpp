// Saddles of the arcs of an accessible surface, by the closed forms of saddle_formulas.hpp.
#pragma once

#include "excluded/patches/saddle_formulas.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

inline Profile profile_of(const RolledArc& arc) {
  return profile_of(arc.circle_radius, arc.height[0], arc.height[1], arc.spindle, arc.cusp_height);
}

// The integral of e(φ) along the arc.
inline Vec3d radial_integral(const RolledArc& arc) {
  if (arc.is_ring()) return {0, 0, 0};
  return cross(arc.axis, arc.radial[0] - arc.radial[1]);
}

inline SaddleMeasures measure_saddle(const RolledArc& arc, double p, const Profile& profile,
                                     std::size_t side) {
  return measure_saddle({arc.angle, arc.circle_radius, arc.axis, radial_integral(arc)}, p, profile,
                        side);
}

}  // namespace vdwmesh::excluded
