// Measures of balls by a regular triangulation and inclusion-exclusion, for balls that the arcs
// cannot measure. For the library's own use.
#pragma once

#include <vector>

#include "arrangement/complex/power_triangulation.hpp"
#include "arrangement/exact_union.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Exposed area and ball ∩ power cell of each ball, in the order of the set. They are right for a
// ball if the set has all balls that overlap it.
std::vector<SphereMeasures> reference_measures(const SphereSet& spheres);

// Measures of the triangulation's balls in the order and the units of the SphereSet. Spheres that
// the triangulation leaves out, because a concentric one covers them, get 0.
std::vector<SphereMeasures> in_order_of(const SphereSet& spheres, const PowerTriangulation& t,
                                        const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
