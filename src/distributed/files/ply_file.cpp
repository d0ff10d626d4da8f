// write_ply(): all vertices take the same number of bytes, and so do all faces. So the number of a
// vertex or face gives its place in the file, and every rank writes its own there.
#include "distributed/files/ply_file.hpp"

#include <fmt/format.h>

#include <string>

#include "core/errors.hpp"
#include "distributed/files/shared_file.hpp"
#include "distributed/ranks.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "mesh/element_color.hpp"
#include "mesh/formats/chunk_writer.hpp"
#include "mesh/formats/ply_records.hpp"

namespace vdwmesh {
namespace {

void write_header(const std::string& header, SharedFile& file) {
  file.write_at(0, header.data(), header.size());
}

// The own vertices of a run of numbers.
void write_vertices(const IndexedMesh& mesh, const VertexNumbers::Run& run,
                    std::span<const RgbColor> colors, ByteSink& sink) {
  formats::ChunkWriter out(sink);
  for (std::size_t v = run.begin; v < run.end; ++v) {
    const VertexSpheres spheres = mesh.vertex_spheres[v];
    const RgbColor color = spheres[0] == kNoSphere ? kPlainColor : colors[spheres[0]];
    out.begin_record();
    formats::write_ply_vertex(out, mesh.positions[v], mesh.normals[v], color, spheres);
  }
  out.flush();
}

// A file has fewer vertices than 2^32 (check_ply_size()).
void write_faces(const SurfacePiece& piece, TriangleLabels labels, ByteSink& sink) {
  formats::ChunkWriter out(sink);
  const auto index_of = [&](std::uint32_t corner) {
    return static_cast<std::uint32_t>(piece.number_of(corner));
  };
  for (std::size_t t = 0; t < piece.mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = piece.mesh.triangles[t];
    out.begin_record();
    formats::write_ply_face(out, {index_of(a), index_of(b), index_of(c)});
    if (labels == TriangleLabels::spheres) {
      out.raw(formats::ply_sphere(piece.mesh.triangle_spheres[t]));
    }
  }
  out.flush();
}

}  // namespace

void check_ply_size(const MeshSize& size) {
  if (size.vertices <= formats::kMostPlyVertices) return;
  throw LimitExceeded(
      fmt::format("{} vertices are more than the {} that a PLY file can name; a "
                  "larger --spacing or --edge-length makes fewer",
                  size.vertices, formats::kMostPlyVertices));
}

void write_ply(const Ranks& ranks, const SurfacePiece& piece, std::span<const RgbColor> colors,
               SharedFile& file) {
  const MeshSize& whole = piece.whole;
  ranks.together([&] {
    const std::string header = formats::ply_header(whole, piece.labels);
    if (ranks.is_first()) write_header(header, file);
    for (const VertexNumbers::Run& run : piece.numbers.runs()) {
      SharedFileSection vertices(file, header.size() + formats::kPlyVertexBytes * run.first);
      write_vertices(piece.mesh, run, colors, vertices);
    }
    SharedFileSection faces(file, header.size() + formats::kPlyVertexBytes * whole.vertices +
                                      formats::ply_face_bytes(piece.labels) * piece.first_triangle);
    write_faces(piece, piece.labels, faces);
  });
}

}  // namespace vdwmesh
