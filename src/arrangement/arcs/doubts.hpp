// Why the measures of one ball are not to be trusted, and the tolerances that say so. Lengths are
// in units of the ball's radius.
#pragma once

#include <cstdint>

namespace vdwmesh::arcs {

// Bits of BallMeasures::doubts.
enum Doubt : std::uint32_t {
  kParallelPlanes = 1,   // two planes that meet inside the ball are parallel, but for rounding
  kIllConditioned = 2,   // circles nearly tangent: angles at a corner have lost their digits
  kThirdCircle = 4,      // three circles or more, or four planes, all but meet in one point
  kTinyArc = 8,          // the exposed angle of a circle is nearly 0 or nearly a whole turn
  kDamaged = 16,         // the cell is no simple polytope, or arcs have an end but no start
  kOpenSurface = 32,     // the vector areas of patch and faces do not add up to zero
  kVanishing = 64,       // a plane removed the rest of the cell, or left it, by next to nothing
  kNotFinite = 128,      // a cap or a measure is NaN or out of its range
  kNearlyTangent = 256,  // two spheres all but touch from outside or inside
  kAlongEdge = 512,      // a plane all but runs along an edge of the cell
};

// These leave no doubt about area and volume, which hardly change when two spheres lose touch or
// three circles meet in a point, but about the numbers of circles, corners and components.
inline constexpr std::uint32_t kOnlyCountsInDoubt = kNearlyTangent | kAlongEdge;

// A vertex beyond a plane by at most this counts as lying on it: 45 machine epsilons.
inline constexpr double kSlack = 1e-14;
// What is nearer to a plane, to the sphere or to another sphere than this may be on either side by
// rounding; the margin over the bound of rounding errors, about 1e-13, is ample.
inline constexpr double kTouching = 1e-9;
// A plane runs along an edge, but for rounding, if both ends of the edge are at most this far from
// it: an angle of 1e-8 between edge and plane moves their common point by 1e-14 / 1e-8 = 1e-6.
inline constexpr double kNearby = 1e-7;
// Below this squared sine (sine 1e-5) of the angle between two planes, rounding moves the line in
// which they meet by 1e-14 / 1e-5 = kTouching.
inline constexpr double kNearlyParallel = 1e-10;
// An exposed angle this near to 0 or 2 pi may be either, by rounding.
inline constexpr double kTinyAngle = 1e-9;
// An angle at a corner is taken to be wrong by its condition number times 64 machine epsilons.
inline constexpr double kRounding = 64 * 2.220446049250313e-16;
// Largest estimated rounding error of a corner's angle that is accepted, in radians.
inline constexpr double kMaxError = 1e-9;
// Largest accepted length of twice the vector area of the surface of ball ∩ power cell, which is 0
// but for rounding.
inline constexpr double kMaxOpen = 1e-10;

}  // namespace vdwmesh::arcs
