// mesh_area_by_sphere(): the area of a mesh, divided among the spheres that its labels name.
//
// A triangle with a label adds its area to the sphere of that label. In a mesh without triangle
// labels each triangle adds a third of its area to the atom of each of its vertices. One pass over
// the triangles, in their order and on one thread, accumulates the sums of all spheres.
#include "analysis/mesh_measures.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

// Å²: half the length of the cross product of two edge vectors.
double area_of(const IndexedMesh& mesh, const Triangle& t) {
  const Vec3d a = mesh.positions[t[0]];
  return 0.5 * norm(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
}

// Calls add(sphere, area in Å²) for all triangles: once for a triangle with a label, and otherwise
// three times, for the atoms of its vertices. Returns false, and stops, at the first label that
// names a sphere id of `count` or above; true if there is none.
template <class Add>
bool visit_areas(const IndexedMesh& mesh, std::size_t count, const Add& add) {
  const bool labelled = mesh.triangle_labels() == TriangleLabels::spheres;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const double area = area_of(mesh, mesh.triangles[t]);
    if (labelled) {
      if (mesh.triangle_spheres[t] >= count) return false;
      add(mesh.triangle_spheres[t], area);
      continue;
    }
    for (const std::uint32_t vertex : mesh.triangles[t]) {
      const SphereId atom = mesh.vertex_spheres.atoms[vertex];
      if (atom >= count) return false;
      add(atom, area / 3);
    }
  }
  return true;
}

}  // namespace

std::vector<double> mesh_area_by_sphere(const IndexedMesh& mesh, std::size_t sphere_count) {
  const bool labelled = mesh.triangle_labels() == TriangleLabels::spheres;
  if (!labelled && mesh.vertex_spheres.size() != mesh.vertex_count()) return {};
  std::vector<WideSum> sums(sphere_count);
  if (!visit_areas(mesh, sphere_count, [&](SphereId s, double area) { sums[s].add(area); })) {
    return {};
  }
  std::vector<double> areas;
  areas.reserve(sphere_count);
  for (const WideSum& sum : sums) areas.push_back(sum.value());
  return areas;
}

}  // namespace vdwmesh
