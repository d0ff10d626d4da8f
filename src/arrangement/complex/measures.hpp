// Area and volume of the union from its dual complex, by two formula sets. They share the complex
// and the circles of two spheres (edge_shape), so they check each other's sums and not the complex;
// the arcs (arcs.hpp) check both.
//
// Lengths are those of the triangulation (scaled). For each ball of the triangulation: the exposed
// area of its sphere and the volume of ball ∩ power cell.
#pragma once

#include <vector>

#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/exact_union.hpp"

namespace vdwmesh {

// Inclusion–exclusion over the dual complex with outer angles (Edelsbrunner 1995; AlphaMol: Liang
// et al. 1998), rearranged into a partition, in which nothing alternates: cones from the centre of
// each ball, ball by ball. A triple intersection enters through the tetrahedron of its three
// centres and a corner, and an edge's circle through the angle that tetrahedra leave free around
// it.
std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex);

// Gauss–Bonnet over the exposed patches (Euler characteristic, arcs, turning angles) and pyramids
// from the centres over the faces of the power cells, from the positions of corners.
std::vector<SphereMeasures> gauss_bonnet(const PowerTriangulation& triangulation,
                                         const DualComplex& complex);

// Both throw InvalidInput through this where a measure is not finite, so that nobody builds on it.
void require_finite(const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
