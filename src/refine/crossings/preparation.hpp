// What every refiner does before its first step, whichever backend it runs on.
#pragma once

#include <cstdint>

#include "extract/field.hpp"
#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "spheres/cell_list.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Workspace;

// The same as refine_bytes() of refiner.hpp, less what these options leave out: normals, and the
// half-edges of the last level. A mesh that is not subdivided counts with all arrays, since it is
// the caller's.
std::uint64_t refine_bytes(const MeshSize& given, std::uint64_t spheres,
                           const RefineOptions& options,
                           TriangleLabels labels = TriangleLabels::none);

// Checks everything that can be checked before memory is taken, except that the mesh is closed.
// Throws InvalidInput for options out of range and for a mesh whose arrays do not fit each other or
// the spheres, LimitExceeded if a level would have too many elements or the memory limit is too
// low.
void check_refinement(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options);

// The part of check_refinement() that needs only sizes, of the sphere set, the mesh and its labels.
// With labels, it also refuses a projection to a field.
void check_refinement_size(std::uint64_t spheres, std::uint64_t vertices, std::uint64_t triangles,
                           const RefineOptions& options,
                           TriangleLabels labels = TriangleLabels::none);

// Its part about the mesh: arrays that fit each other, indices and labels in range, coordinates
// that are finite.
void check_mesh(const SphereSet& spheres, const IndexedMesh& mesh);

// Completes labels and normals of the given mesh for level 0. Afterwards each vertex has a label of
// three ids, all kNoSphere if no labels were given. Normals are removed if none are wanted, or if
// the mesh is projected, because they are then computed anew at the end.
IndexedMesh complete_labels(IndexedMesh given, const RefineOptions& options);
// Completes all of it: opposite half-edges are there too if a subdivision follows. Throws
// InvalidInput if the mesh is not closed then.
IndexedMesh prepare_mesh(IndexedMesh given, const RefineOptions& options);

// The blended field to project to, used for Projection::field only. Throws InvalidInput if this
// projection is chosen and the field is no blended one, the grid has no spacing, or field options
// are out of range.
FieldModel projection_model(const RefineOptions& options);
// The cell list in which the projection searches for balls. It is empty if nothing is searched: if
// triangles name their spheres, or without projection. Its memory belongs to `workspace`. Throws
// like projection_model().
CellListView projection_list(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace);

// The surface that a CPU refinement projects to; project() must not be called where the list above
// is empty. The arrays belong to `spheres` and `workspace`. Throws like projection_model().
SurfaceView target_surface(const SphereSet& spheres, const RefineOptions& options,
                           TriangleLabels labels, Workspace& workspace);

}  // namespace vdwmesh
