// One refinement level on the CPU: subdivision, projection, and taking bad moves back. The CPU
// refiner calls project_given() once and subdivide() once per subdivision. Both throw Cancelled
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

// A higher level: subdivides `parent` once, projects the midpoints and takes bad moves back.
// Precondition: `parent` has `opposite`. The result has it too, unless its half-edges do not fit 32
// bits. It has normals only if `parent` has them.
struct SubdividedMesh {
  IndexedMesh mesh;
  ProjectionStats stats;
};
SubdividedMesh subdivide(const SphereSet& spheres, const TargetSurface& surface,
                         const IndexedMesh& parent, const RefineOptions& options);

}  // namespace vdwmesh
