// Area and volume of the union from its dual complex. The measures from arcs (arcs/arcs.hpp) share
// nothing with them, and so check them and the complex.
//
// The functions return one entry for each ball of the triangulation: the exposed area of its sphere
// and the volume of ball ∩ power cell. Lengths are scaled as in the triangulation.
#pragma once

#include <vector>

#include "complex/dual_complex.hpp"
#include "measures/exact_union.hpp"

namespace vdwmesh {

// Inclusion–exclusion over the dual complex with outer angles (Edelsbrunner 1995; AlphaMol: Liang
// et al. 1998). The terms are rearranged so that they divide each ball into cones from its centre,
// instead of adding and subtracting intersections in turn. Three spheres that meet in a corner
// enter through the tetrahedron of their centres and the corner. The circle of an edge enters
// through the angle that tetrahedra leave free around the edge.
std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex);

// The exposed angle of an edge's circle, and the area of the power face in the balls.
struct EdgeCone {
  double angle, face;
};
// The same measures, and the cones of the complex's edges.
std::vector<SphereMeasures> inclusion_exclusion(const PowerTriangulation& triangulation,
                                                const DualComplex& complex,
                                                std::vector<EdgeCone>& cones);

// Its areas alone, whatever becomes of the volumes. Refuses exposed balls whose radius is 0 too.
std::vector<double> exposed_areas(const PowerTriangulation& triangulation,
                                  const DualComplex& complex);

// Throws InvalidInput if a measure is not finite. All functions above call it with their results.
void require_finite(const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
