// Area and volume of the union from its dual complex, by two sets of formulas.
//
// The two sets share the complex and the circles of two spheres (edge_shape). So they check each
// other's sums, but not the complex. The arcs (arcs/arcs.hpp) check both.
//
// Both functions return one entry for each ball of the triangulation: the exposed area of its
// sphere and the volume of ball ∩ power cell. Lengths are scaled as in the triangulation.
#pragma once

#include <vector>

#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/exact_union.hpp"

namespace vdwmesh {

// Inclusion–exclusion over the dual complex with outer angles (Edelsbrunner 1995; AlphaMol: Liang
// et al. 1998). The terms are rearranged into a partition of each ball into cones from its centre,
// so that no signs alternate. A triple intersection enters through the tetrahedron of its three
// centres and a corner. The circle of an edge enters through the angle that tetrahedra leave free
// around the edge.
std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex);

// Gauss–Bonnet over the exposed patches (Euler characteristic, arcs, turning angles), and pyramids
// from the centres over the faces of the power cells. It computes with the positions of corners.
std::vector<SphereMeasures> gauss_bonnet(const PowerTriangulation& triangulation,
                                         const DualComplex& complex);

// Throws InvalidInput if a measure is not finite. Both functions above call it with their results.
void require_finite(const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
