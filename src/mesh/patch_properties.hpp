// What a PatchedMesh knows beside its IndexedMesh, as properties of a SurfaceMesh: PLY files have
// them.
#pragma once

#include <array>
#include <optional>

#include "mesh/surface_mesh.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

struct PatchProperties {
  OpenMesh::FPropHandleT<PatchKind> kind;
  OpenMesh::FPropHandleT<std::array<SphereId, 3>> atoms;  // as SurfacePatch::atoms
  // As vertex_curvatures(), 1/Å and 1/Å².
  OpenMesh::VPropHandleT<float> mean_curvature, gaussian_curvature;
};

// Adds the properties to a mesh that was built of `source.mesh`. Throws InvalidInput if it has
// other numbers of vertices or faces, and as check_patches() does.
void add_patch_properties(SurfaceMesh& mesh, const PatchedMesh& source);

// The properties, if the mesh has them.
std::optional<PatchProperties> patch_properties(const SurfaceMesh& mesh);

}  // namespace vdwmesh
