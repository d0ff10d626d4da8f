// Betti numbers of the union and the connected shells of its boundary, from the dual complex.
//
// Components are the connected components of the complex's graph. Voids are the bounded components
// of its complement. Tunnels follow from the Euler characteristic (Delfinado and Edelsbrunner 1995,
// "An incremental algorithm for Betti numbers of simplicial complexes on the 3-sphere").
#pragma once

#include <vector>

#include "complex/dual_complex.hpp"
#include "measures/exact_union.hpp"

namespace vdwmesh {

// `measures` has one entry for each ball of the triangulation, for example from
// inclusion_exclusion(). Areas and volumes of the result are scaled as the triangulation is.
// hidden_spheres counts balls of the triangulation only, not spheres that it left out.
UnionTopology union_topology(const PowerTriangulation& triangulation, const DualComplex& complex,
                             const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
