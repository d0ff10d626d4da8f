// Writer and reader of OFF, the Object File Format of Geomview, in its text form.
//
// A file is a keyword, the counts of vertices, faces and edges, one line per vertex and one line
// per face (number of corners, then indices from 0). The keyword announces what a vertex line has
// beside the position: [ST][C][N]OFF, for texture coordinates, a colour and a normal, whose letters
// MeshLab writes in another order, or OFF[+N][+A] of NanoShaper, for a normal and an atom. Normals
// follow the position in all of them and are read; all else is skipped, as are colours of faces.
// The keyword may be missing (Geomview), the first count may follow it without a blank (ModelNet),
// and the count of edges may be missing. The writer makes a plain OFF without a comment, which
// programs may take for the counts.
#include <fmt/format.h>

#include <algorithm>

#include "core/errors.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/connect/polygons.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/record_writer.hpp"
#include "mesh/formats/text_scanner.hpp"

namespace vdwmesh::formats {
namespace {

class OffReader {
 public:
  explicit OffReader(std::string_view text) : in_(text) {}

  MeshFile read() {
    read_keyword();
    const auto vertices = count("vertices", has_normals_ ? 6 : 3);
    const auto faces = count("faces", 1);
    if (!in_.at_line_end())
      (void)in_.integer<std::uint64_t>();  // edges: many programs write 0 or a wrong number
    in_.next_line();
    check_vertex_limit(vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) read_vertex();
    for (std::uint64_t i = 0; i < faces; ++i) read_face();
    if (!in_.at_end())
      in_.fail(
          fmt::format("more follows than the {} vertices and {} faces promised", vertices, faces));
    polygons_.finish(file_);
    return std::move(file_);
  }

 private:
  // Reads the keyword, and leaves the position at the first of the counts.
  void read_keyword() {
    in_.skip_to_token();
    const char* const start = in_.position();
    const std::string_view word = in_.word();
    const auto is_count = [](std::string_view text) {
      return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
    };
    if (is_count(word)) return in_.move_to(start);
    const std::size_t off = word.find("OFF");
    if (off == std::string_view::npos) in_.fail("an OFF file begins with 'OFF'");
    const std::string_view after = word.substr(off + 3);
    read_kind(word, word.substr(0, off), is_count(after) ? std::string_view() : after);
    if (is_count(after)) return in_.move_to(after.data());
    const char* const counts = in_.position();
    in_.skip_blanks();
    if (in_.word() == "BINARY") in_.fail("binary OFF is not read here");
    in_.move_to(counts);
  }

  // Reads what stands before and after the letters OFF of the keyword.
  void read_kind(std::string_view word, std::string_view before, std::string_view after) {
    const auto take = [](std::string_view& text, std::string_view part) {
      const bool there = text.starts_with(part);
      if (there) text.remove_prefix(part.size());
      return there;
    };
    while (!before.empty()) {
      if (take(before, "N")) {
        has_normals_ = true;
      } else if (!take(before, "ST") && !take(before, "C")) {
        break;
      }
    }
    while (!after.empty()) {
      if (take(after, "+N")) {
        has_normals_ = true;
      } else if (!take(after, "+A")) {
        break;
      }
    }
    if (!before.empty() || !after.empty())
      in_.fail(fmt::format("'{}' is a kind of OFF that is not read here", word.substr(0, 24)));
  }

  // Reads a count from the header; `what` names the elements in messages. Each element has at least
  // `numbers` numbers, and each number takes at least two bytes, a digit and a separator. Only the
  // last number of the file needs no separator, hence + 1. A count that cannot fit into the rest of
  // the file is an error.
  std::uint64_t count(const char* what, std::size_t numbers) {
    in_.skip_to_token();
    const auto value = in_.integer<std::uint64_t>();
    if (value > in_.bytes_left() / (2 * numbers) + 1)
      in_.fail(fmt::format("{} {} are promised, but {} bytes are left for them", value, what,
                           in_.bytes_left()));
    return value;
  }

  // The next three numbers, which may stand on several lines.
  Vec3d vector() {
    Vec3d result;
    for (int axis = 0; axis < 3; ++axis) {
      in_.skip_to_token();
      result[axis] = in_.number();
    }
    return result;
  }

  // The normal follows the position directly; colour and texture come after it and are skipped with
  // the rest of the line.
  void read_vertex() {
    file_.mesh.positions.push_back(vector());
    if (has_normals_) file_.mesh.normals.push_back(cast<float>(vector()));
    in_.next_line();
  }

  // A colour at the end of the line is skipped.
  void read_face() {
    in_.skip_to_token();
    const auto corners = in_.integer<std::uint32_t>();
    polygon_.clear();
    for (std::uint32_t k = 0; k < corners; ++k) {
      in_.skip_to_token();
      const auto v = in_.integer<std::uint32_t>();
      if (v >= file_.mesh.vertex_count())
        in_.fail(
            fmt::format("a face names vertex {}, but there are {}", v, file_.mesh.vertex_count()));
      polygon_.push_back(v);
    }
    in_.next_line();
    polygons_.add(file_.mesh, polygon_);
  }

  TextScanner in_;
  MeshFile file_;
  bool has_normals_ = false;
  Polygons polygons_;
  std::vector<std::uint32_t> polygon_;  // corners of the face that is being read
};

// From the opposite half-edges if the mesh has them.
std::size_t count_edges(const IndexedMesh& mesh) {
  std::size_t edges = 0;
  if (!mesh.opposite.empty()) {
    for (std::size_t h = 0; h < mesh.opposite.size(); ++h) edges += h < mesh.opposite[h];
    return edges;
  }
  const EdgeBuckets buckets(mesh.triangles, mesh.vertex_count());
  for (std::size_t v = 0; v < buckets.vertex_count(); ++v)
    for_each_edge(buckets.at(v), [&](std::span<const EdgeEntry>) { ++edges; });
  return edges;
}

}  // namespace

void write_off(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  // An estimate: three doubles of about 18 characters per vertex, three 7-digit indices per face.
  sink.expect(58 * mesh.vertex_count() + 27 * mesh.triangle_count());
  const std::string header =
      fmt::format("OFF\n{} {} {}\n", mesh.vertex_count(), mesh.triangle_count(), count_edges(mesh));
  sink.write(header.data(), header.size());
  constexpr std::size_t kMostPerLine = 3 * (RecordBytes::kMostPerNumber + 1) + 2;
  write_records(sink, mesh.vertex_count(), kMostPerLine, [&](RecordBytes& out, std::size_t v) {
    const Vec3d p = view.position(v);
    for (int k = 0; k < 3; ++k) {
      out.number(p[k]);
      out.character(k < 2 ? ' ' : '\n');
    }
  });
  write_records(sink, mesh.triangle_count(), kMostPerLine, [&](RecordBytes& out, std::size_t f) {
    out.character('3');
    for (const std::uint32_t v : mesh.triangles[f]) {
      out.character(' ');
      out.number(v);
    }
    out.character('\n');
  });
}

MeshFile read_off(std::string_view bytes) {
  const PlainText text(bytes);
  return OffReader(text.view()).read();
}

}  // namespace vdwmesh::formats
