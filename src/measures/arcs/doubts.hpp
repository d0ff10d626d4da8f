// Doubts: reasons why the measures of one ball may be wrong, and the tolerances from which on a
// reason holds. Lengths are in units of the ball's radius.
//
// kNearby, kNearlyParallel and kRounding follow from rounding as the comments say. kTouching,
// kTinyAngle, kMaxError and kMaxOpen are chosen: far above the rounding of well-conditioned steps,
// and far below what shows in a measure. No proof bounds what slips through; the comparison with
// the exact triangulation (docs/exact_mesh.md, tests/contract/) is what speaks for them.
#pragma once

#include <cstdint>

namespace vdwmesh::arcs {

// Bits of BallMeasures::doubts.
enum Doubt : std::uint32_t {
  kParallelPlanes = 1,  // two planes that meet inside the ball are nearly parallel
  kIllConditioned = 2,  // two circles are nearly tangent, so angles at their corners lose digits
  kThirdCircle = 4,     // three circles or more, or four planes, nearly meet in one point
  kTinyArc = 8,         // the exposed angle of a circle is nearly 0 or nearly a whole turn
  kDamaged = 16,        // the cell is no simple polytope, or arcs have an end but no start
  kOpenSurface = 32,    // the vector areas of patch and faces do not add up to zero
  kVanishing = 64,      // rounding may decide whether a plane removed all that was left of the cell
  kNotFinite = 128,     // a cap or a measure is NaN or out of its range
  kNearlyTangent = 256,  // two spheres nearly touch, from outside or from inside
  kAlongEdge = 512,      // a plane nearly contains an edge of the cell
};

// These doubts concern only the numbers of circles, corners and components. Area and volume are not
// in doubt, because they hardly change when two spheres lose contact or three circles meet in a
// point.
inline constexpr std::uint32_t kOnlyCountsInDoubt = kNearlyTangent | kAlongEdge;

// A vertex beyond a plane by at most this counts as lying on it: 45 machine epsilons.
inline constexpr double kSlack = 1e-14;
// Rounding may decide on which side of a plane or sphere a point lies that is nearer to it than
// this. Rounding of well-conditioned points comes to about 1e-13, which leaves a factor of 10,000.
inline constexpr double kTouching = 1e-9;
// A plane nearly contains an edge if both ends of the edge are at most this far from it. At an
// angle of 1e-8 between edge and plane, rounding moves their common point by 1e-14 / 1e-8 = 1e-6.
inline constexpr double kNearby = 1e-7;
// Below this squared sine (sine 1e-5) of the angle between two planes, rounding moves the line in
// which they meet by 1e-14 / 1e-5 = kTouching.
inline constexpr double kNearlyParallel = 1e-10;
// Rounding may decide between 0 and 2 pi if an exposed angle is this near to one of them.
inline constexpr double kTinyAngle = 1e-9;
// The estimated rounding error of an angle at a corner is its condition number times 64 machine
// epsilons.
inline constexpr double kRounding = 64 * 2.220446049250313e-16;
// Largest estimated rounding error of a corner's angle that is accepted, in radians.
inline constexpr double kMaxError = 1e-9;
// Largest accepted length of twice the vector area of the surface of ball ∩ power cell. Without
// rounding it is 0.
inline constexpr double kMaxOpen = 1e-10;

}  // namespace vdwmesh::arcs
