// Writer of PLY, the only format here that keeps everything a mesh has: double positions,
// normals, colours, the sphere ids of vertices and faces, and patches with their curvatures. The
// file is binary little-endian, or text with a line for each record. The order of the properties in
// kHeader is the order in which write_ply_vertex() and write_ply_face() append the values.
#include <fmt/format.h>

#include <limits>
#include <string>

#include "core/errors.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/ply_records.hpp"
#include "mesh/formats/record_writer.hpp"

namespace vdwmesh::formats {
namespace {

// A format string for nine values: form of the file, its unit, comments on faces and on patches,
// number of vertices, curvatures of vertices, number of faces, type of their indices, properties of
// faces. Texts are empty for what the mesh does not have: spheres of triangles, or patches.
constexpr const char* kHeader =
    "ply\n"
    "format {} 1.0\n"
    "comment made by vdwmesh; {}\n"
    "comment atom, sphere2, sphere3: indices of the spheres a vertex lies on, -1 for none\n"
    "{}{}"
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
    "{}"
    "element face {}\n"
    "property list uchar {} vertex_indices\n"
    "{}{}"
    "end_header\n";
constexpr const char* kFaceComment = "comment atom of a face: index of the sphere it is part of\n";
constexpr const char* kFaceProperty = "property int atom\n";
// Named otherwise than the atom of a face, because triangles of saddles lie on no sphere.
constexpr const char* kPatchComment =
    "comment patch_kind of a face: 0 contact, 1 saddle, 2 concave\n"
    "comment patch_atom1, patch_atom2, patch_atom3 of a face: indices of the spheres that make its "
    "patch, -1 for none\n"
    "comment mean_curvature, gaussian_curvature of a vertex: 1/{0}, 1/{0}^2, positive where the "
    "surface is convex\n";
constexpr const char* kCurvatureProperties =
    "property float mean_curvature\n"
    "property float gaussian_curvature\n";
constexpr const char* kPatchProperties =
    "property uchar patch_kind\n"
    "property int patch_atom1\n"
    "property int patch_atom2\n"
    "property int patch_atom3\n";

}  // namespace

std::string ply_header(const MeshSize& size, TriangleLabels labels, PatchLabels patches,
                       MeshEncoding encoding, double scale) {
  const bool labelled = labels == TriangleLabels::spheres;
  const bool patched = patches == PatchLabels::patches;
  const std::string patch_comment = fmt::format(kPatchComment, scale == 1 ? "angstrom" : "length");
  return fmt::format(kHeader, encoding == MeshEncoding::text ? "ascii" : "binary_little_endian",
                     unit_text(scale), labelled ? kFaceComment : "", patched ? patch_comment : "",
                     size.vertices, patched ? kCurvatureProperties : "", size.triangles,
                     size.vertices <= kMostIntPlyVertices ? "int" : "uint",
                     labelled ? kFaceProperty : "", patched ? kPatchProperties : "");
}

std::int32_t ply_sphere(SphereId id) {
  if (id == kNoSphere) return -1;
  if (id > static_cast<SphereId>(std::numeric_limits<std::int32_t>::max()))
    throw LimitExceeded(fmt::format("sphere {} is beyond PLY's int; leave some spheres out", id));
  return static_cast<std::int32_t>(id);
}

namespace {

// write_records() in the form of the file: a line for each record, or its `bytes`. record(out, i)
// calls out.raw() with the values.
template <class Record>
void write_values(ByteSink& sink, MeshEncoding encoding, std::size_t count, std::uint64_t bytes,
                  const Record& record) {
  constexpr std::size_t kMostValues = 16;  // of a vertex or a face
  if (encoding == MeshEncoding::binary) return write_records(sink, count, bytes, record);
  write_records(sink, count, kMostValues * (RecordBytes::kMostPerNumber + 1),
                [&](RecordBytes& out, std::size_t i) {
                  RecordWords line(out);
                  record(line, i);
                  out.character('\n');
                });
}

}  // namespace

void write_ply(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  const PatchedMesh* const patched = view.patches;
  const TriangleLabels labels = mesh.triangle_labels();
  const std::string header =
      ply_header({mesh.vertex_count(), mesh.triangle_count()}, labels,
                 patched ? PatchLabels::patches : PatchLabels::none, view.encoding, view.scale);
  const std::uint64_t vertex_bytes = kPlyVertexBytes + (patched ? kPlyCurvatureBytes : 0);
  const std::uint64_t face_bytes = ply_face_bytes(labels) + (patched ? kPlyPatchBytes : 0);
  const std::uint64_t times = view.encoding == MeshEncoding::text ? 2 : 1;  // about
  sink.expect(header.size() +
              times * (vertex_bytes * mesh.vertex_count() + face_bytes * mesh.triangle_count()));
  sink.write(header.data(), header.size());
  const bool labelled = !mesh.vertex_spheres.empty();
  const VertexCurvatures curvatures = patched ? vertex_curvatures(*patched) : VertexCurvatures{};
  const auto vertex = [&](auto& out, std::size_t v) {
    const VertexSpheres spheres = labelled ? mesh.vertex_spheres[v] : on_sphere(kNoSphere);
    write_ply_vertex(out, view.position(v), view.normals[v], view.color(v), spheres);
    if (!patched) return;
    out.raw(static_cast<float>(curvatures.mean[v] / view.scale));
    out.raw(static_cast<float>(curvatures.gaussian[v] / (view.scale * view.scale)));
  };
  const auto face = [&](auto& out, std::size_t t) {
    write_ply_face(out, mesh.triangles[t]);
    if (labels == TriangleLabels::spheres) out.raw(ply_sphere(mesh.triangle_spheres[t]));
    if (!patched) return;
    const SurfacePatch& patch = patched->patches[patched->triangle_patch[t]];
    out.raw(static_cast<std::uint8_t>(patch.kind));
    for (const SphereId id : patch.atoms) out.raw(ply_sphere(id));
  };
  write_values(sink, view.encoding, mesh.vertex_count(), vertex_bytes, vertex);
  write_values(sink, view.encoding, mesh.triangle_count(), face_bytes, face);
}

}  // namespace vdwmesh::formats
