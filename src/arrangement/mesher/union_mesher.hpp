// The crease-exact mesh of an arrangement, from its boundary as it was placed.
#pragma once

#include <vector>

#include "arrangement/exact_mesher.hpp"
#include "arrangement/exact_union.hpp"
#include "arrangement/mesher/boundary_arcs.hpp"
#include "core/errors.hpp"

namespace vdwmesh {

// What a set of balls has in common, whatever is meshed. Lengths are those of the triangulation.
struct Arrangement {
  PowerTriangulation triangulation;
  DualComplex complex;
  std::vector<SphereMeasures> measures;
};

// Thrown where curves of the boundary lie too close to be told apart: other feature sizes may help.
class CurvesTooClose : public LimitExceeded {
  using LimitExceeded::LimitExceeded;
};

// Throws CurvesTooClose, LimitExceeded, Cancelled.
ExactMesh mesh_boundary(const Arrangement& arrangement, BoundaryArcs&& boundary,
                        const ExactMeshOptions& options);

}  // namespace vdwmesh
