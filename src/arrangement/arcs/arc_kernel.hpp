// One ball of a union, for host and device: no allocation, no containers, memory of the caller.
//
// The exposed part of a sphere is its intersection with the ball's power cell. So only caps whose
// plane bounds the cell have to be looked at, and the volume of ball ∩ power cell comes from the
// same edges as the exposed area.
#pragma once

#include "arrangement/arcs/arc_measure.hpp"

namespace vdwmesh::arcs {

// How far a plane is moved, at most, where too many meet in one point. Times the length of the
// arcs, a few radii, it bounds the error of the area, in units of the radius; and it is far above
// rounding.
inline constexpr double kNudge = 2e-11;
inline constexpr std::uint64_t kNudges = 8;  // attempts

// Whether an earlier of the sorted caps has all but the same plane, and so leaves nothing to cut.
VDWMESH_HD inline bool repeats_plane(const Cap* caps, std::uint32_t index, std::uint32_t& doubts) {
  const Cap& cap = caps[index];
  for (std::uint32_t i = index; i > 0 && cap.cosine - caps[i - 1].cosine < kParallelGap; --i) {
    const Cap& earlier = caps[i - 1];
    if (inner(cap.axis, earlier.axis) < 0) continue;
    const Vec3d normal = cross(cap.axis, earlier.axis);
    if (inner(normal, normal) >= kParallel) continue;
    if (!same_cap(cap, earlier)) doubts |= kParallelPlanes;
    return true;
  }
  return false;
}

// Caps sorted.
VDWMESH_HD inline BallMeasures measure_sorted(const Cap* caps, std::uint32_t count,
                                              const ArcWorkspace& workspace, EdgeEnding ending) {
  BallCell cell(workspace, ending);
  std::uint32_t doubts = 0;
  for (std::uint32_t i = 0; i < count && !cell.empty() && !cell.overflowed(); ++i) {
    if (cell.out_of_reach(caps[i].cosine)) break;
    if (!repeats_plane(caps, i, doubts)) cell.cut(caps[i]);
  }
  BallMeasures measures = measure_cell(cell, caps, count);
  measures.doubts |= doubts;
  return measures;
}

// Copies the caps, each plane moved by its own amount, at most kNudge; each attempt differently.
VDWMESH_HD inline void nudge_caps(const Cap* caps, std::uint32_t count, std::uint64_t attempt,
                                  Cap* nudged) {
  for (std::uint32_t i = 0; i < count; ++i) {
    // SplitMix64.
    std::uint64_t bits = (attempt << 32) + i + 0x9e3779b97f4a7c15u;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
    bits ^= bits >> 31;
    nudged[i] = caps[i];
    nudged[i].cosine += kNudge * (std::ldexp(static_cast<double>(bits >> 11), -52) - 1);
  }
}

// Area of the exposed sphere and volume of ball ∩ power cell, both for the unit ball. Sorts the
// caps; the result does not depend on the order they come in. Where the checks leave a doubt, the
// numbers are those of planes nudged apart, if these pass the checks; the doubt stays. Where the
// workspace is too small they are meaningless, and the doubt kOverflow says so.
VDWMESH_HD inline BallMeasures measure_ball(Cap* caps, std::uint32_t count,
                                            const ArcWorkspace& workspace) {
  if (count == 0) return {4 * kPi, 4 * kPi / 3, 0};
  sort_caps(caps, count);
  const BallMeasures plain = measure_sorted(caps, count, workspace, EdgeEnding::direct);
  if (plain.doubts == 0 || (plain.doubts & kOverflow)) return plain;
  for (std::uint64_t attempt = 0; attempt < kNudges; ++attempt) {
    nudge_caps(caps, count, attempt, workspace.nudged);
    sort_caps(workspace.nudged, count);
    const BallMeasures nudged =
        measure_sorted(workspace.nudged, count, workspace, EdgeEnding::shared);
    const bool failed =
        nudged.doubts & (kOverflow | kGaussBonnet | kOpenSurface | kVanished | kNotFinite);
    if (!failed) return {nudged.area, nudged.volume, plain.doubts};
  }
  return plain;
}

}  // namespace vdwmesh::arcs
