// The steps of one level: subdivision, projection, and the moves taken back. All throw Cancelled
// soon after the options' monitor asks for it.
#pragma once

#include <cstdint>

#include "refine/refiner.hpp"
#include "refine/target_surface.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Projects the vertices of a mesh that prepare_mesh() made, and takes back the bad moves.
ProjectionStats project_given(const SphereSet& spheres, const TargetSurface& surface,
                              IndexedMesh& mesh, const RefineOptions& options);

// Subdivides `parent` (with `opposite`) once and projects the midpoints.
struct SubdividedMesh {
  IndexedMesh mesh;
  ProjectionStats stats;
};
SubdividedMesh subdivide(const SphereSet& spheres, const TargetSurface& surface,
                         const IndexedMesh& parent, const RefineOptions& options);

}  // namespace vdwmesh
