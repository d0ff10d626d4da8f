// Comparison of a mesh with the exact excluded surface that it approximates: errors of area, volume
// and topology. The distances between the two surfaces are in excluded_distances.hpp.
#pragma once

#include "analysis/comparison.hpp"
#include "analysis/mesh_measures.hpp"
#include "excluded/excluded_measures.hpp"

namespace vdwmesh {

// Fills all members of a Comparison but `distances`. Sheets of the surface that touch are kept
// apart, as a 2-manifold keeps them, so the difference of the Euler characteristics is the plain
// one; it is empty for meshes that are not closed manifolds, and if the surface has no topology.
Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExcludedSurface& exact);

}  // namespace vdwmesh
