// The angle of an exposed arc from the dihedral angles of the triangulation: right to rounding
// where the arc's corners are too near to each other, or to the centre of its circle, to tell
// nothing from a whole turn.
#pragma once

#include "arrangement/complex/exposed_arcs.hpp"
#include "arrangement/complex/simplex_shape.hpp"

namespace vdwmesh {

// Circles smaller than this (squared, by the squared radius of the smaller sphere) have corners too
// near to their centre for angles between them; and arcs this near to nothing (rad) may round to a
// whole turn.
inline constexpr double kSmallCircle = 1e-6;
inline constexpr double kSmallArc = 1e-6;

// Precondition: the arc has corners.
double angle_by_dihedrals(const PowerTriangulation& triangulation, const DualComplex& complex,
                          const ExposedArc& arc);

}  // namespace vdwmesh
