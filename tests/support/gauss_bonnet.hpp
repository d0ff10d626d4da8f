// Area and volume of a union by formulas other than the library's, from the same complex: the
// Gauss-Bonnet theorem over the exposed patches (Euler characteristic, arcs, turning angles), and
// pyramids from the centres over the faces of the power cells. The inclusion-exclusion of the
// library is held against them.
#pragma once

#include "measures/exact_union.hpp"

namespace vdwmesh::testing {

// Of the whole union, Å² and Å³.
SphereMeasures by_gauss_bonnet(const SphereSet& spheres);

}  // namespace vdwmesh::testing
