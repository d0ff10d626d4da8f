// Access to the sphere properties of a SurfaceMesh, and its conversion back to an IndexedMesh.
//
// to_surface_mesh() hands its work to SurfaceMeshBuilder. to_indexed_mesh() copies vertices and
// faces on all cores. The first corner of a triangle is the start of the half-edge that OpenMesh
// keeps for the face, so converting a mesh there and back keeps the order of its corners.
#include "mesh/surface_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "mesh/surface_handles.hpp"
#include "mesh/surface_mesh_builder.hpp"

namespace vdwmesh {

using handles::face;
using handles::vertex;

VertexSpheresProperty vertex_spheres(const SurfaceMesh& mesh) {
  VertexSpheresProperty property;
  if (!mesh.get_property_handle(property, kVertexSpheresName))
    throw InvalidInput(fmt::format("the mesh has no vertex property {}", kVertexSpheresName));
  return property;
}

std::optional<FaceSphereProperty> face_spheres(const SurfaceMesh& mesh) {
  FaceSphereProperty property;
  if (!mesh.get_property_handle(property, kFaceSphereName)) return {};
  return property;
}

// The loops in parallel only find whether all is well; what is named is the first, for any number
// of threads. all_faces() and all_vertices() visit deleted elements too.
void check_nothing_deleted(const SurfaceMesh& mesh) {
  std::atomic<bool> all_kept = true;
  for_each_index(mesh.n_faces(), [&](std::size_t f) {
    if (mesh.status(face(f)).deleted()) all_kept = false;
  });
  for_each_index(mesh.n_vertices(), [&](std::size_t v) {
    if (mesh.status(vertex(v)).deleted()) all_kept = false;
  });
  if (all_kept) return;
  for (const auto f : mesh.all_faces())
    if (mesh.status(f).deleted())
      throw InvalidInput(fmt::format("face {} is deleted: collect the garbage first", f.idx()));
  for (const auto v : mesh.all_vertices())
    if (mesh.status(v).deleted())
      throw InvalidInput(fmt::format("vertex {} is deleted: collect the garbage first", v.idx()));
}

SurfaceMesh to_surface_mesh(const IndexedMesh& source) {
  SurfaceMesh mesh;
  SurfaceMeshBuilder(mesh).build(source);
  return mesh;
}

IndexedMesh to_indexed_mesh(const SurfaceMesh& mesh) {
  check_nothing_deleted(mesh);
  IndexedMesh result;
  const std::size_t vertices = mesh.n_vertices(), triangles = mesh.n_faces();
  const VertexSpheresProperty spheres = vertex_spheres(mesh);
  result.positions.resize(vertices);
  result.normals.resize(vertices);
  result.vertex_spheres.resize(vertices, LabelWidth::three);
  for_each_index(vertices, [&](std::size_t v) {
    const auto& p = mesh.point(vertex(v));
    const auto& n = mesh.normal(vertex(v));
    result.positions[v] = {p[0], p[1], p[2]};
    result.normals[v] = {n[0], n[1], n[2]};
    result.vertex_spheres.set(v, mesh.property(spheres, vertex(v)));
  });
  // OpenMesh numbers half-edges by edge, IndexedMesh by triangle. index_of maps the number of
  // OpenMesh to 3t + k. A half-edge on a boundary belongs to no triangle. Its element stays
  // kNoOpposite, which is the value that `opposite` needs for the half-edge on the other side.
  Buffer<std::uint32_t> index_of(mesh.n_halfedges());
  std::fill(index_of.begin(), index_of.end(), kNoOpposite);
  result.triangles.resize(triangles);
  for_each_index(triangles, [&](std::size_t t) {
    auto h = mesh.halfedge_handle(face(t));
    for (unsigned k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h)) {
      index_of[static_cast<std::size_t>(h.idx())] = static_cast<std::uint32_t>(3 * t + k);
      result.triangles[t][k] = static_cast<std::uint32_t>(mesh.from_vertex_handle(h).idx());
    }
  });
  if (const std::optional<FaceSphereProperty> spheres_of_faces = face_spheres(mesh)) {
    result.triangle_spheres.resize(triangles);
    for_each_index(triangles, [&](std::size_t t) {
      result.triangle_spheres[t] = mesh.property(*spheres_of_faces, face(t));
    });
  }
  // A second pass over the faces, because it needs the complete index_of.
  result.opposite.resize(3 * triangles);
  for_each_index(triangles, [&](std::size_t t) {
    auto h = mesh.halfedge_handle(face(t));
    for (unsigned k = 0; k < 3; ++k, h = mesh.next_halfedge_handle(h))
      result.opposite[3 * t + k] =
          index_of[static_cast<std::size_t>(mesh.opposite_halfedge_handle(h).idx())];
  });
  return result;
}

}  // namespace vdwmesh
