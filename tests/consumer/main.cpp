// A program outside the project: sample in; mesh, crease-exact mesh, exact union and picture out.
#include <cstdio>
#include <vdwmesh/analysis/distances.hpp>
#include <vdwmesh/analysis/mesh_measures.hpp>
#include <vdwmesh/creases/exact_mesher.hpp>
#include <vdwmesh/cuda/backend.hpp>
#include <vdwmesh/measures/exact_union.hpp>
#include <vdwmesh/mesh/mesh_io.hpp>
#include <vdwmesh/mesh/surface_mesh.hpp>
#include <vdwmesh/render/crease_split.hpp>
#include <vdwmesh/render/renderer.hpp>
#include <vdwmesh/structure/radii.hpp>
#include <vdwmesh/structure/reader.hpp>

int main() {
  std::vector<vdwmesh::Sphere> spheres;
  for (const vdwmesh::Atom& atom : vdwmesh::read_sample("ubiquitin").atoms) {
    spheres.push_back({atom.position, atom.radius});
  }
  const vdwmesh::SphereSet molecule(std::move(spheres));

  vdwmesh::RefineOptions refine;
  refine.projection = vdwmesh::Projection::none;
  const auto pipeline = vdwmesh::make_pipeline(vdwmesh::Backend::cpu);
  const vdwmesh::IndexedMesh mesh = pipeline->run(molecule, {}, refine).mesh;
  const vdwmesh::SurfaceMesh surface = vdwmesh::to_surface_mesh(mesh);

  const double exact = vdwmesh::exact_union(molecule).area;
  const double area = vdwmesh::measures(mesh).area;
  const double crease_area = vdwmesh::measures(vdwmesh::mesh_union(molecule).mesh).area;
  std::printf("%zu faces, area %.3f of %.3f square angstrom, with creases %.3f\n",
              surface.n_faces(), area, exact, crease_area);
  try {
    const vdwmesh::MeshSource source(mesh, vdwmesh::Rgb{0.8f, 0.8f, 0.8f});
    const vdwmesh::Picture picture = vdwmesh::Renderer().draw(source, {});
    std::printf("picture of %zu bytes\n", vdwmesh::encode_png(picture).size());
  } catch (const vdwmesh::BackendUnavailable& error) {
    std::printf("%s\n", error.what());
  }
  // Marching cubes at 0.5 Å cut the creases between the spheres: 4 to 6 % of the area. The mesh
  // that follows them only has its triangles inside the spheres.
  const bool as_expected = area > 0.94 * exact && area < 0.96 * exact &&
                           crease_area > 0.98 * exact && crease_area < exact;
  return as_expected ? 0 : 1;
}
