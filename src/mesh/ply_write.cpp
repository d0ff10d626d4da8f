// Writer of PLY, the only format here that keeps everything a SurfaceMesh has: double positions,
// normals, colours and the sphere ids of vertices and faces. The file is binary little-endian. The
// order of the properties in kHeader is the order in which write_ply_vertex() and write_ply_face()
// append the values.
#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>

#include "core/errors.hpp"
#include "mesh/chunk_writer.hpp"
#include "mesh/formats.hpp"
#include "mesh/ply_records.hpp"

namespace vdwmesh::formats {
namespace {

// A format string for five values: comment on faces, number of vertices, number of faces, type of
// their indices, property of faces. The first and the last value are empty unless the mesh has
// face_spheres().
constexpr const char* kHeader =
    "ply\n"
    "format binary_little_endian 1.0\n"
    "comment made by vdwmesh; lengths in angstrom\n"
    "comment atom, sphere2, sphere3: indices of the spheres a vertex lies on, -1 for none\n"
    "{}"
    "element vertex {}\n"
    "property double x\n"
    "property double y\n"
    "property double z\n"
    "property float nx\n"
    "property float ny\n"
    "property float nz\n"
    "property uchar red\n"
    "property uchar green\n"
    "property uchar blue\n"
    "property int atom\n"
    "property int sphere2\n"
    "property int sphere3\n"
    "element face {}\n"
    "property list uchar {} vertex_indices\n"
    "{}"
    "end_header\n";
constexpr const char* kFaceComment = "comment atom of a face: index of the sphere it is part of\n";
constexpr const char* kFaceProperty = "property int atom\n";

}  // namespace

std::string ply_header(const MeshSize& size, TriangleLabels labels) {
  const bool labelled = labels == TriangleLabels::spheres;
  return fmt::format(kHeader, labelled ? kFaceComment : "", size.vertices, size.triangles,
                     size.vertices <= kMostIntPlyVertices ? "int" : "uint",
                     labelled ? kFaceProperty : "");
}

std::int32_t ply_sphere(SphereId id) {
  if (id == kNoSphere) return -1;
  if (id > static_cast<SphereId>(std::numeric_limits<std::int32_t>::max()))
    throw LimitExceeded(fmt::format("sphere {} is beyond PLY's int; leave some spheres out", id));
  return static_cast<std::int32_t>(id);
}

void write_ply(const SurfaceMesh& mesh, ByteSink& sink) {
  const std::optional<FaceSphereProperty> sphere = face_spheres(mesh);
  const TriangleLabels labels = sphere ? TriangleLabels::spheres : TriangleLabels::none;
  const std::string header = ply_header({mesh.n_vertices(), mesh.n_faces()}, labels);
  sink.expect(header.size() + kPlyVertexBytes * mesh.n_vertices() +
              ply_face_bytes(labels) * mesh.n_faces());
  ChunkWriter out(sink);
  out.text(header);
  const VertexSpheresProperty spheres = vertex_spheres(mesh);
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const auto v = vertex_handle(i);
    write_ply_vertex(out, mesh.point(v), mesh.normal(v), mesh.color(v), mesh.property(spheres, v));
  }
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    write_ply_face(out, face_vertices(mesh, f));
    if (sphere)
      out.raw(ply_sphere(mesh.property(*sphere, OpenMesh::FaceHandle(static_cast<int>(f)))));
  }
  out.flush();
}

}  // namespace vdwmesh::formats
