// Refines a surface whose triangles say on which spheres they lie, by all ranks together.
#pragma once

#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

// What refine_together() does with such a surface: the piece becomes that of the mesh that
// Refiner::refine() makes, bit for bit. Collective.
std::vector<ProjectionStats> constrain_together(const Ranks& ranks, const SphereSet& spheres,
                                                const RefineOptions& options, SurfacePiece& piece);

}  // namespace vdwmesh
