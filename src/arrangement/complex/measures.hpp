// Area and volume of the union from its dual complex, by two sets of formulas.
//
// Both sets use the same complex and the same circles in which two spheres meet (edge_shape()). So
// they check each other's sums, but not the complex. The measures from arcs (arcs/arcs.hpp) share
// nothing with them and check the complex too.
//
// The first two functions return one entry for each ball of the triangulation: the exposed area of
// its sphere and the volume of ball ∩ power cell. Lengths are scaled as in the triangulation.
#pragma once

#include <vector>

#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/exact_union.hpp"

namespace vdwmesh {

// Inclusion–exclusion over the dual complex with outer angles (Edelsbrunner 1995; AlphaMol: Liang
// et al. 1998). The terms are rearranged so that they divide each ball into cones from its centre,
// instead of adding and subtracting intersections in turn. Three spheres that meet in a corner
// enter through the tetrahedron of their centres and the corner. The circle of an edge enters
// through the angle that tetrahedra leave free around the edge.
std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex);

// Gauss–Bonnet over the exposed patches (Euler characteristic, arcs, turning angles), and pyramids
// from the centres over the faces of the power cells. It computes with the positions of corners.
std::vector<SphereMeasures> gauss_bonnet(const PowerTriangulation& triangulation,
                                         const DualComplex& complex);

// The exposed areas of gauss_bonnet() alone, bit by bit, in a fraction of its time.
std::vector<double> exposed_areas(const PowerTriangulation& triangulation,
                                  const DualComplex& complex);

// Throws InvalidInput if a measure is not finite. All functions above call it with their results.
void require_finite(const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
