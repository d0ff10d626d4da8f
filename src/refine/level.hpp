// One refinement level on the CPU: subdivision, projection, and taking bad moves back (which moves
// are bad: refine/crossings/bad_moves.hpp). The CPU refiner calls project_given() once, for level
// 0, and then subdivide() once per subdivision. Both throw Cancelled soon after the options'
// monitor asks for it.
#pragma once

#include <cstdint>

#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Projects the vertices of a mesh that prepare_mesh() made, and takes back the bad moves. If the
// triangles of the mesh are labelled, no vertex is moved; it is only counted how many lie on the
// spheres of their labels.
ProjectionStats project_given(const SphereSet& spheres, const SurfaceView& surface,
                              IndexedMesh& mesh, const RefineOptions& options);

// Whether the mesh that is subdivided is itself the result of a subdivision. The search for
// crossings is then cheaper; the mesh is the same.
enum class ParentOrigin : std::uint8_t { given, subdivided };

// Subdivides `parent` once, projects the midpoints and takes bad moves back. If triangles are
// labelled, no move is bad. Precondition: `parent` has `opposite`. The result has `opposite` too if
// that is wanted and its half-edges can be numbered in 32 bits (kMaxHalfEdges). It has normals only
// if `parent` has them.
struct SubdividedMesh {
  IndexedMesh mesh;
  ProjectionStats stats;
};
SubdividedMesh subdivide(const SphereSet& spheres, const SurfaceView& surface,
                         const IndexedMesh& parent, ParentOrigin origin, Connectivity connectivity,
                         const RefineOptions& options);

}  // namespace vdwmesh
