// The steps of one level: subdivision, projection, and the moves taken back.
#pragma once

#include <cstdint>

#include "extract/indexed_mesh.hpp"
#include "refine/refiner.hpp"
#include "refine/target_surface.hpp"

namespace vdwmesh {

// What became of a vertex on the level that handled it.
enum class Fate : std::uint8_t { stayed, moved, taking_back, taken_back };

// Projects the vertices of a copy of `given`, and takes back the moves that turn a triangle.
ProjectionStats project_given(const SphereSet& spheres, const TargetSurface& surface,
                              const IndexedMesh& given, IndexedMesh& mesh);

// Subdivides `parent` (with `opposite`) once and projects the midpoints.
struct SubdividedMesh {
  IndexedMesh mesh;
  ProjectionStats stats;
};
SubdividedMesh subdivide(const SphereSet& spheres, const TargetSurface& surface,
                         const IndexedMesh& parent);

}  // namespace vdwmesh
