// The angle of an exposed arc, from the dihedral angles of the triangulation.
//
// Usually callers compute the angle of an arc as the angle between its two corners, seen from the
// centre of the circle. That fails if the corners are too near to the centre, or so near to each
// other that an angle of nearly 0 and one of nearly 2 π cannot be distinguished. The computation
// from dihedral angles is slower, but right to rounding in these cases too.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "complex/boundary/exposed_arcs.hpp"
#include "complex/simplex_shape.hpp"

namespace vdwmesh {

// Limits for the usual computation. On a circle whose squared radius is below kSmallCircle times
// the squared radius of the smaller sphere, the corners are too near to the centre. If the angle
// between the corners is below kSmallArc (rad), the arc may be nearly nothing or nearly a whole
// turn.
inline constexpr double kSmallCircle = 1e-6;
inline constexpr double kSmallArc = 1e-6;

// Returns the angle in radians, between 0 and 2 π up to rounding. Precondition: the arc has
// corners, that is, it is not a whole circle.
double angle_by_dihedrals(const PowerTriangulation& triangulation, const DualComplex& complex,
                          const ExposedArc& arc);
// The same for the arc of the circle of two balls (`edge`, the axis runs from its first ball to its
// second) that begins and ends at corners of these triangles, each with the edge and a third ball.
double angle_by_dihedrals(const std::vector<Sphere>& balls,
                          const std::array<std::uint32_t, 2>& edge,
                          const std::array<std::uint32_t, 3>& start,
                          const std::array<std::uint32_t, 3>& end);

}  // namespace vdwmesh
