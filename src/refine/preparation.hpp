// What every refiner does before its first step, whichever backend it runs on.
#pragma once

#include <cstdint>

#include "core/workspace.hpp"
#include "extract/field.hpp"
#include "refine/refiner.hpp"
#include "spheres/cell_list.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Throws InvalidInput for options without sense or a mesh that does not fit the spheres,
// LimitExceeded for sizes and bytes.
void check_refinement(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options);

// The part of it that needs only the sizes.
void check_refinement_size(std::uint64_t spheres, std::uint64_t vertices, std::uint64_t triangles,
                           const RefineOptions& options,
                           TriangleLabels labels = TriangleLabels::none);

// The given mesh as level 0 begins with it: labels there, half-edges where a subdivision follows.
// Normals are computed at the end, unless there is no surface to take them from.
IndexedMesh prepare_mesh(IndexedMesh given, const RefineOptions& options);

// The field and the list that the projection searches, which is empty where triangles name their
// spheres. The list is the workspace's: see field_list(). Throw InvalidInput for options without
// sense.
FieldModel projection_model(const RefineOptions& options);
CellListView projection_list(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace);

}  // namespace vdwmesh
