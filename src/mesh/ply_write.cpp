// Writer of PLY, the only format here that keeps everything a SurfaceMesh has: double positions,
// normals, colours and the sphere ids of vertices and faces. The file is binary little-endian. The
// order of the properties in kHeader is the order in which write_ply() appends the values.
#include <fmt/format.h>

#include <limits>
#include <optional>

#include "core/errors.hpp"
#include "mesh/chunk_writer.hpp"
#include "mesh/formats.hpp"

namespace vdwmesh::formats {
namespace {

// A format string for four values: comment on faces, number of vertices, number of faces, property
// of faces. The first and the last value are empty unless the mesh has face_spheres().
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
    "property list uchar int vertex_indices\n"
    "{}"
    "end_header\n";
constexpr const char* kFaceComment = "comment atom of a face: index of the sphere it is part of\n";
constexpr const char* kFaceProperty = "property int atom\n";

constexpr std::size_t kMaxHeaderBytes = 1024;  // bytes; the text above has fewer than 800

// The number of a sphere in the file. It is an int, so that -1 can stand for kNoSphere.
std::int32_t as_int(SphereId id) {
  if (id == kNoSphere) return -1;
  if (id > static_cast<SphereId>(std::numeric_limits<std::int32_t>::max()))
    throw LimitExceeded(fmt::format("sphere {} is beyond PLY's int; leave some spheres out", id));
  return static_cast<std::int32_t>(id);
}

}  // namespace

void write_ply(const SurfaceMesh& mesh, ByteSink& sink) {
  const std::optional<FaceSphereProperty> sphere = face_spheres(mesh);
  // A vertex has 3 doubles, 3 floats, 3 bytes and 3 ints: 24 + 12 + 3 + 12 = 51 bytes. A face has a
  // count of one byte and 3 ints, and 4 more bytes for its sphere.
  sink.expect(kMaxHeaderBytes + 51 * mesh.n_vertices() + (sphere ? 17 : 13) * mesh.n_faces());
  ChunkWriter out(sink);
  out.text(fmt::format(kHeader, sphere ? kFaceComment : "", mesh.n_vertices(), mesh.n_faces(),
                       sphere ? kFaceProperty : ""));
  const VertexSpheresProperty spheres = vertex_spheres(mesh);
  for (std::size_t i = 0; i < mesh.n_vertices(); ++i) {
    const auto v = vertex_handle(i);
    out.begin_record();
    for (unsigned k = 0; k < 3; ++k) out.raw(mesh.point(v)[k]);
    for (unsigned k = 0; k < 3; ++k) out.raw(mesh.normal(v)[k]);
    for (unsigned k = 0; k < 3; ++k) out.raw(mesh.color(v)[k]);
    for (const SphereId id : mesh.property(spheres, v)) out.raw(as_int(id));
  }
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    out.begin_record();
    out.raw(std::uint8_t{3});
    out.raw(face_vertices(mesh, f));
    if (sphere) out.raw(as_int(mesh.property(*sphere, OpenMesh::FaceHandle(static_cast<int>(f)))));
  }
  out.flush();
}

}  // namespace vdwmesh::formats
