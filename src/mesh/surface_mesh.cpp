// Access to the sphere properties of a SurfaceMesh, and its conversion from and to an IndexedMesh.
//
// to_surface_mesh() takes four steps: check the sizes of all arrays; find the opposite half-edges
// unless the source has them; link the half-edges (connectivity.cpp); copy positions, normals and
// labels on all cores. to_indexed_mesh() copies vertices and faces on all cores. The first corner
// of a triangle is the start of the half-edge that OpenMesh keeps for the face, so converting a
// mesh there and back keeps the order of its corners.
#include "mesh/surface_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <span>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "mesh/connect/connectivity.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/element_color.hpp"
#include "mesh/surface_handles.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {

using handles::face;
using handles::vertex;

namespace {

// Until color_by_element() or the user sets another colour.
const SurfaceMesh::Color kFirstColor{kPlainColor[0], kPlainColor[1], kPlainColor[2]};

// OpenMesh's handles are of type int, which limits vertices and half-edges alike.
void check_limits(std::size_t vertices, std::size_t triangles) {
  constexpr auto kMaxHandle = static_cast<std::size_t>(std::numeric_limits<int>::max());
  if (vertices > kMaxHandle || triangles > kMaxSurfaceHalfEdges / 3)
    throw LimitExceeded(
        fmt::format("{} vertices and {} triangles are more than OpenMesh's {} half-edges can "
                    "hold; a coarser spacing makes fewer",
                    vertices, triangles, kMaxSurfaceHalfEdges));
}

// The unit vector along a, or zero if a is zero or not a number.
Vec3f unit(const Vec3d& a) {
  const double length = norm(a);
  if (!(length > 0)) return {0, 0, 0};
  return {static_cast<float>(a.x / length), static_cast<float>(a.y / length),
          static_cast<float>(a.z / length)};
}

void set_vertex_data(SurfaceMesh& mesh, const IndexedMesh& source, VertexSpheresProperty spheres) {
  Buffer<Vec3f> computed;
  if (source.normals.empty()) computed = normals_of_triangles(source);
  const std::span normals = source.normals.empty() ? std::span<const Vec3f>(computed)
                                                   : std::span<const Vec3f>(source.normals);
  for_each_index(source.vertex_count(), [&](std::size_t v) {
    const Vec3d& p = source.positions[v];
    mesh.set_point(vertex(v), {p.x, p.y, p.z});
    mesh.set_color(vertex(v), kFirstColor);
    mesh.set_normal(vertex(v), {normals[v].x, normals[v].y, normals[v].z});
    mesh.property(spheres, vertex(v)) =
        source.vertex_spheres.empty() ? on_sphere(kNoSphere) : source.vertex_spheres[v];
  });
}

// Adds the face property of face_spheres() if the source labels its triangles.
void set_face_data(SurfaceMesh& mesh, const IndexedMesh& source) {
  if (source.triangle_labels() == TriangleLabels::none) return;
  FaceSphereProperty spheres;
  mesh.add_property(spheres, kFaceSphereName);
  for_each_index(source.triangle_count(), [&](std::size_t t) {
    mesh.property(spheres, face(t)) = source.triangle_spheres[t];
  });
}

}  // namespace

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

// The sums run on one thread, because threads could add to the same vertex at the same time. Their
// order, and so the result, is always the same.
Buffer<Vec3f> normals_of_triangles(const IndexedMesh& mesh) {
  Buffer<Vec3d> sums(mesh.vertex_count());
  std::fill(sums.begin(), sums.end(), Vec3d{0, 0, 0});
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d area =
        cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
    for (const std::uint32_t v : {a, b, c}) sums[v] = sums[v] + area;
  }
  Buffer<Vec3f> normals(sums.size());
  for_each_index(sums.size(), [&](std::size_t v) { normals[v] = unit(sums[v]); });
  return normals;
}

SurfaceMesh to_surface_mesh(const IndexedMesh& source) {
  check_limits(source.vertex_count(), source.triangle_count());
  check_array_sizes(source);
  const bool given = !source.opposite.empty();
  Buffer<std::uint32_t> computed;
  if (!given) computed = opposite_half_edges(source.triangles, source.vertex_count());
  SurfaceMesh mesh;
  VertexSpheresProperty spheres;
  mesh.add_property(spheres, kVertexSpheresName);
  connect(mesh, source.triangles, given ? std::span(source.opposite) : std::span(computed),
          source.vertex_count(), given ? Opposites::given : Opposites::computed);
  set_vertex_data(mesh, source, spheres);
  set_face_data(mesh, source);
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
