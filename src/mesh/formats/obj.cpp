// Writer and reader of Wavefront OBJ.
//
// The first word of a line says what it holds: "v" a position, "vn" a normal, "f" a face. Other
// lines (textures, groups, materials, lines, curves) are skipped. The corners of a face name a
// vertex and may name a texture and a normal: v, v/vt, v//vn or v/vt/vn. So a vertex may have
// several normals, and may be named before it is defined. IndexedMesh has one normal per vertex.
// The reader keeps the first normal that a face names for the vertex. Unless every vertex has one,
// the mesh gets no normals at all.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/errors.hpp"
#include "mesh/connect/polygons.hpp"
#include "mesh/formats/chunk_writer.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/text_scanner.hpp"

namespace vdwmesh::formats {
namespace {

class ObjReader {
 public:
  explicit ObjReader(std::string_view text) : in_(text) {}

  MeshFile read() {
    for (; !in_.at_end(); in_.next_line()) {
      const std::string_view keyword = in_.word();
      if (keyword == "v") {
        check_vertex_limit(mesh().positions.size() + 1);
        mesh().positions.push_back(vector());
      } else if (keyword == "vn") {
        normals_.push_back(cast<float>(vector()));
      } else if (keyword == "f") {
        read_face();
      }
    }
    check_forward();
    give_normals();
    polygons_.finish(file_);
    return std::move(file_);
  }

 private:
  IndexedMesh& mesh() { return file_.mesh; }

  // The next three numbers of the line.
  Vec3d vector() {
    const double x = in_.number();
    const double y = in_.number();
    return {x, y, in_.number()};
  }

  // Reads the corners of a face, in any of the four forms above.
  void read_face() {
    polygon_.clear();
    while (!in_.at_line_end()) {
      const std::uint32_t v = index(mesh().positions.size());
      note_forward(v);
      polygon_.push_back(v);
      if (!in_.take('/')) continue;
      if (!in_.take('/')) {
        (void)in_.integer<std::int64_t>();  // the index of a texture, which is skipped
        if (!in_.take('/')) continue;
      }
      set_normal(v, index(normals_.size()));
    }
    polygons_.add(mesh(), polygon_);
  }

  // Reads an index and converts it to an index from 0. The file counts from 1; negative indices
  // count backwards, and -1 is the last of the `count` elements read so far. The result is not
  // compared with `count`, because a face may name elements that follow. 2^32 - 1 is refused,
  // because kNoNormal has this value.
  std::uint32_t index(std::size_t count) {
    const auto value = in_.integer<std::int64_t>();
    const std::int64_t from_zero = value > 0 ? value - 1 : static_cast<std::int64_t>(count) + value;
    if (value == 0 || from_zero < 0 || from_zero >= static_cast<std::int64_t>(kMaxVertices) - 1)
      in_.fail(fmt::format("{} is no index here", value));
    return static_cast<std::uint32_t>(from_zero);
  }

  // A face may name a vertex that is not read yet. Notes the largest such index v and where it
  // stands in the file; check_forward() compares it with the number of vertices at the end of the
  // file.
  void note_forward(std::uint32_t v) {
    if (v < mesh().positions.size() || v < largest_forward_index_) return;
    largest_forward_index_ = v;
    largest_forward_position_ = in_.position();
  }
  void check_forward() {
    if (largest_forward_position_ && largest_forward_index_ >= mesh().positions.size())
      in_.fail_at(largest_forward_position_,
                  fmt::format("a face names vertex {}, but there are {}",
                              std::uint64_t{largest_forward_index_} + 1, mesh().positions.size()));
  }

  // Gives vertex v a normal unless it has one. `normal` is an index into normals_, whose element
  // may follow later; give_normals() checks that.
  void set_normal(std::uint32_t v, std::uint32_t normal) {
    if (normal_of_.size() <= v) {
      // A vertex that is not read yet gets no normal here: otherwise a hostile index could demand
      // an array of any size.
      if (v >= mesh().positions.size()) return;
      normal_of_.resize(mesh().positions.size(), kNoNormal);
    }
    if (normal_of_[v] == kNoNormal) normal_of_[v] = normal;
    several_normals_ |= normal_of_[v] != normal;
  }

  // Fills mesh().normals if every vertex has a normal that exists.
  void give_normals() {
    if (normals_.empty() || normal_of_.size() != mesh().positions.size()) return;
    const auto exists = [&](std::uint32_t n) { return n < normals_.size(); };
    if (!std::all_of(normal_of_.begin(), normal_of_.end(), exists)) return;
    mesh().normals.resize(normal_of_.size());
    std::transform(normal_of_.begin(), normal_of_.end(), mesh().normals.begin(),
                   [&](std::uint32_t n) { return normals_[n]; });
    if (several_normals_)
      file_.notes.push_back("where a vertex has several normals, its first was taken");
  }

  static constexpr std::uint32_t kNoNormal = 0xffffffffu;

  TextScanner in_;
  MeshFile file_;
  Buffer<Vec3f> normals_;                    // as the "vn" lines give them
  std::vector<std::uint32_t> normal_of_;     // vertex -> index into normals_, or kNoNormal
  bool several_normals_ = false;             // a vertex was given two different normals
  std::uint32_t largest_forward_index_ = 0;  // largest index named before its vertex was read
  const char* largest_forward_position_ = nullptr;  // where the file names it; null if nowhere
  Polygons polygons_;
  std::vector<std::uint32_t> polygon_;  // corners of the face that is being read
};

}  // namespace

void write_obj(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  // An estimate for full doubles and floats per vertex, and six 7-digit indices per face.
  sink.expect(96 * mesh.vertex_count() + 52 * mesh.triangle_count());
  const std::string header = fmt::format("# made by vdwmesh; {}\n", unit_text(view.scale));
  sink.write(header.data(), header.size());
  constexpr std::size_t kMostPerVector = 3 * (RecordBytes::kMostPerNumber + 1) + 3;
  // "f" and three times " 4294967295//4294967295".
  constexpr std::size_t kMostPerFace = 3 * (2 * RecordBytes::kMostPerNumber + 3) + 2;
  // `kind` is the letter after the v, or a blank for a position.
  const auto write_vector = [](RecordBytes& out, char kind, const auto& vector) {
    out.character('v');
    if (kind != ' ') out.character(kind);
    for (int k = 0; k < 3; ++k) {
      out.character(' ');
      out.number(vector[k]);
    }
    out.character('\n');
  };
  write_records(sink, mesh.vertex_count(), kMostPerVector,
                [&](RecordBytes& out, std::size_t v) { write_vector(out, ' ', view.position(v)); });
  write_records(sink, mesh.vertex_count(), kMostPerVector,
                [&](RecordBytes& out, std::size_t v) { write_vector(out, 'n', view.normals[v]); });
  write_records(sink, mesh.triangle_count(), kMostPerFace, [&](RecordBytes& out, std::size_t f) {
    out.character('f');
    for (const std::uint32_t v : mesh.triangles[f]) {
      out.character(' ');
      out.number(v + 1);
      out.character('/');
      out.character('/');
      out.number(v + 1);
    }
    out.character('\n');
  });
}

MeshFile read_obj(std::string_view bytes) {
  const PlainText text(bytes);
  return ObjReader(text.view()).read();
}

}  // namespace vdwmesh::formats
