// Copies the patches of triangles and the curvatures of vertices into properties of a SurfaceMesh,
// whose handles have the numbers of the IndexedMesh.
#include "mesh/patch_properties.hpp"

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "mesh/surface_handles.hpp"

namespace vdwmesh {
namespace {

constexpr const char* kKindName = "f:patch_kind";
constexpr const char* kAtomsName = "f:patch_atoms";
constexpr const char* kMeanName = "v:mean_curvature";
constexpr const char* kGaussianName = "v:gaussian_curvature";

}  // namespace

void add_patch_properties(SurfaceMesh& mesh, const PatchedMesh& source) {
  check_patches(source);
  if (mesh.n_vertices() != source.mesh.vertex_count() ||
      mesh.n_faces() != source.triangle_patch.size()) {
    throw InvalidInput("the patches are those of another mesh");
  }
  PatchProperties p;
  mesh.add_property(p.kind, kKindName);
  mesh.add_property(p.atoms, kAtomsName);
  mesh.add_property(p.mean_curvature, kMeanName);
  mesh.add_property(p.gaussian_curvature, kGaussianName);
  for_each_index(mesh.n_faces(), [&](std::size_t t) {
    const SurfacePatch& patch = source.patches[source.triangle_patch[t]];
    mesh.property(p.kind, handles::face(t)) = patch.kind;
    mesh.property(p.atoms, handles::face(t)) = patch.atoms;
  });
  const VertexCurvatures curvatures = vertex_curvatures(source);
  for_each_index(mesh.n_vertices(), [&](std::size_t v) {
    mesh.property(p.mean_curvature, handles::vertex(v)) = curvatures.mean[v];
    mesh.property(p.gaussian_curvature, handles::vertex(v)) = curvatures.gaussian[v];
  });
}

std::optional<PatchProperties> patch_properties(const SurfaceMesh& mesh) {
  PatchProperties p;
  if (!mesh.get_property_handle(p.kind, kKindName) ||
      !mesh.get_property_handle(p.atoms, kAtomsName) ||
      !mesh.get_property_handle(p.mean_curvature, kMeanName) ||
      !mesh.get_property_handle(p.gaussian_curvature, kGaussianName)) {
    return std::nullopt;
  }
  return p;
}

}  // namespace vdwmesh
