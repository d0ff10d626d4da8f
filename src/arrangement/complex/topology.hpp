// Betti numbers of the union and the connected shells of its boundary, from the dual complex.
//
// Components are those of the complex's graph, voids the bounded components of its complement, and
// tunnels follow from the Euler characteristic, as in space they must (Delfinado and Edelsbrunner
// 1995, "An incremental algorithm for Betti numbers of simplicial complexes on the 3-sphere").
#pragma once

#include <vector>

#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/exact_union.hpp"

namespace vdwmesh {

// `measures` are those of the triangulation's balls; lengths stay scaled. A void is a component of
// the complement other than the outer one. Each pair of a complement component and a component of
// the union that touches it has exactly one shell, and these pairs form a tree: that gives the
// volume inside each shell. hidden_spheres counts the balls of the triangulation only.
UnionTopology union_topology(const PowerTriangulation& triangulation, const DualComplex& complex,
                             const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
