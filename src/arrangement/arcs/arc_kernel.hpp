// Measures one ball of a union from its caps. Runs on host and device, so it allocates nothing and
// works in memory of the caller.
//
// The exposed part of a sphere is its intersection with the power cell of the ball. Only caps whose
// planes bound the cell matter, and the edges of ball ∩ power cell give both the exposed area and
// the volume.
//
// 1. measure_sorted() cuts the ball by the caps, the largest first, and measures what is left.
// 2. If a check leaves a doubt, measure_ball() repeats this with nudged planes: each is moved along
//    its axis by a small random amount, so that no more than three of them meet in a point.
#pragma once

#include <algorithm>

#include "arrangement/arcs/arc_measure.hpp"
#include "core/split_mix.hpp"

namespace vdwmesh::arcs {

// The largest distance by which a plane is nudged, in units of the radius. A plane that moves by δ
// changes the exposed area by δ times the exposed angle of its circle, at most 2 π δ (the area of a
// spherical zone is 2 π times its height). So the area is wrong by some 1e-10. The nudge is 10^5
// machine epsilons and so decides degenerate cases reliably. It is below kTouching, so nudged
// planes may still raise the doubts that depend on kTouching.
inline constexpr double kNudge = 2e-11;
inline constexpr std::uint64_t kNudges = 8;  // attempts at most, each with other random amounts

// Whether an earlier cap of the sorted list has the same plane as cap `index` to rounding, so that
// this cap need not be cut off. If the two caps are not equal to the last bit, adds the doubt
// kParallelPlanes. Earlier caps whose distance is smaller by kParallelGap have other planes.
inline bool repeats_plane(const Cap* caps, std::uint32_t index, std::uint32_t& doubts) {
  const Cap& cap = caps[index];
  for (std::uint32_t i = index; i > 0 && cap.cosine - caps[i - 1].cosine < kParallelGap; --i) {
    const Cap& earlier = caps[i - 1];
    if (inner(cap.axis, earlier.axis) < 0) continue;  // the planes face each other
    const Vec3d normal = cross(cap.axis, earlier.axis);
    if (inner(normal, normal) >= kParallel) continue;
    if (!same_cap(cap, earlier)) doubts |= kParallelPlanes;
    return true;
  }
  return false;
}

// Cuts the unit ball by the sorted caps and measures what is left. The loop ends early if nothing
// is left, or if the body lies before all further planes, which are no nearer to the centre than
// this one (BallCell::out_of_reach()).
inline BallMeasures measure_sorted(const Cap* caps, std::uint32_t count,
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

// Copies the caps, each plane moved by a pseudo-random amount in [-kNudge, kNudge). The amount
// depends on the number of the attempt and the index in the sorted list alone, so results are
// reproducible.
inline void nudge_caps(const Cap* caps, std::uint32_t count, std::uint64_t attempt, Cap* nudged) {
  for (std::uint32_t i = 0; i < count; ++i) {
    // The upper 53 bits become a double in [-1, 1).
    const std::uint64_t bits = split_mix((attempt << 32) + i + kSplitMixStep);
    nudged[i] = caps[i];
    nudged[i].cosine += kNudge * (std::ldexp(static_cast<double>(bits >> 11), -52) - 1);
  }
}

// Returns the area of the exposed sphere and the volume of ball ∩ power cell, for the unit ball.
// Sorts the caps in place, so the result does not depend on the order in which they come.
// If a check leaves a doubt, area and volume come from the first nudged planes that pass the
// checks, or from the given planes if none do; the doubts are always those of the given planes. If
// the workspace is too small, the bit kOverflow is set and the numbers mean nothing.
inline BallMeasures measure_ball(Cap* caps, std::uint32_t count, const ArcWorkspace& workspace) {
  if (count == 0) return {4 * std::numbers::pi, 4 * std::numbers::pi / 3, 0};
  std::sort(caps, caps + count, cuts_deeper);
  const BallMeasures plain = measure_sorted(caps, count, workspace, EdgeEnding::direct);
  if (plain.doubts == 0 || (plain.doubts & kOverflow)) return plain;
  for (std::uint64_t attempt = 0; attempt < kNudges; ++attempt) {
    nudge_caps(caps, count, attempt, workspace.nudged);
    std::sort(workspace.nudged, workspace.nudged + count, cuts_deeper);
    const BallMeasures nudged =
        measure_sorted(workspace.nudged, count, workspace, EdgeEnding::shared);
    // The doubts left out here say that planes meet within kTouching, which nudged planes may do.
    const bool failed =
        nudged.doubts & (kOverflow | kGaussBonnet | kOpenSurface | kVanished | kNotFinite);
    if (!failed) return {nudged.area, nudged.volume, plain.doubts};
  }
  return plain;
}

}  // namespace vdwmesh::arcs
