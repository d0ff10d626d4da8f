// Every rank writes its vertices and its faces where the numbers before them put them: all vertices
// take the same number of bytes, and so do all faces.
#include "distributed/ply_file.hpp"

#include <fmt/format.h>

#include <string>

#include "core/errors.hpp"
#include "mesh/element_color.hpp"
#include "mesh/ply_records.hpp"

namespace vdwmesh {
namespace {

void write_header(const std::string& header, SharedFile& file) {
  file.write_at(0, header.data(), header.size());
}

void write_vertices(const IndexedMesh& mesh, std::span<const RgbColor> colors, ByteSink& sink) {
  formats::ChunkWriter out(sink);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const VertexSpheres spheres = mesh.vertex_spheres[v];
    const RgbColor color = spheres[0] == kNoSphere ? kPlainColor : colors[spheres[0]];
    formats::write_ply_vertex(out, mesh.positions[v], mesh.normals[v], color, spheres);
  }
  out.flush();
}

void write_faces(const IndexedMesh& mesh, ByteSink& sink) {
  formats::ChunkWriter out(sink);
  for (const Triangle& corners : mesh.triangles) formats::write_ply_face(out, corners);
  out.flush();
}

}  // namespace

void check_ply_size(const MeshSize& size) {
  if (size.vertices <= formats::kMostPlyVertices) return;
  throw LimitExceeded(
      fmt::format("{} vertices are more than the {} that a PLY file can name; a "
                  "larger --spacing makes fewer",
                  size.vertices, formats::kMostPlyVertices));
}

void write_ply(const Ranks& ranks, const SurfacePiece& piece, std::span<const RgbColor> colors,
               SharedFile& file) {
  const MeshSize &whole = piece.whole, &first = piece.first;
  ranks.together([&] {
    const std::string header = formats::ply_header(whole, TriangleLabels::none);
    if (ranks.is_first()) write_header(header, file);
    SharedFileSection vertices(file, header.size() + formats::kPlyVertexBytes * first.vertices);
    write_vertices(piece.mesh, colors, vertices);
    SharedFileSection faces(file,
                            header.size() + formats::kPlyVertexBytes * whole.vertices +
                                formats::ply_face_bytes(TriangleLabels::none) * first.triangles);
    write_faces(piece.mesh, faces);
  });
}

}  // namespace vdwmesh
