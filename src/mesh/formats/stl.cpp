// Writer and reader of STL, in both forms.
//
// A binary file is a header of 80 bytes of any text, a uint32 number of triangles, and 50 bytes per
// triangle: normal and three corners as 12 float32, then a uint16 that is 0. A text file is a list
// of facets between "solid" and "endsolid". STL has no indices, so a corner is repeated for every
// triangle around it; the reader welds corners with equal coordinates. Normals are not read, as the
// corners determine them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "core/letters.hpp"
#include "mesh/connect/polygons.hpp"
#include "mesh/connect/vertex_welder.hpp"
#include "mesh/formats/chunk_writer.hpp"
#include "mesh/formats/float_loss.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/record_writer.hpp"
#include "mesh/formats/text_scanner.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::size_t kHeaderSize = 80;
constexpr std::size_t kFirstTriangle = kHeaderSize + sizeof(std::uint32_t);
constexpr std::size_t kTriangleSize = 50;

// Zero for a degenerate triangle, which has no normal.
Vec3f unit_normal(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const Vec3d normal = cross(b - a, c - a);
  const double length = norm(normal);
  return length > 0 ? cast<float>((1 / length) * normal) : Vec3f{0, 0, 0};
}

// Marks the mesh as welded and adds the note that says so.
void note_welding(MeshFile& file, std::size_t triangles) {
  file.welded = true;
  file.notes.push_back(
      fmt::format("STL has no indices: the {} corners were welded to {} vertices where all three "
                  "coordinates are equal",
                  3 * triangles, file.mesh.vertex_count()));
}

// The number of triangles that the header of a binary file claims. Precondition: at least
// kFirstTriangle bytes.
std::uint32_t promised_triangles(std::string_view bytes) {
  std::uint32_t count;
  std::memcpy(&count, bytes.data() + kHeaderSize, sizeof count);
  return count;
}

// Reads the three corners of a triangle of a binary file into corners[0] to corners[2], and skips
// its normal, which comes first. The sum of three coordinates is not finite if one of them is not,
// and cannot overflow otherwise, because the doubles were floats. So one test is enough.
void read_corners(std::string_view bytes, std::size_t triangle, Vec3d* corners) {
  const std::size_t at = kFirstTriangle + kTriangleSize * triangle;
  std::array<Vec3f, 4> numbers;
  std::memcpy(numbers.data(), bytes.data() + at, sizeof numbers);
  for (unsigned k = 0; k < 3; ++k) {
    corners[k] = cast<double>(numbers[k + 1]);
    if (!std::isfinite(corners[k].x + corners[k].y + corners[k].z))
      throw FileFormatError(
          fmt::format("byte {}: a corner of triangle {} is not finite", at, triangle));
  }
}

// Precondition: the file is as long as its number of triangles needs. Triangles are read in blocks
// of 32, because VertexWelder, which gives equal points the same index, takes up to kMost = 96
// points at a time.
MeshFile read_binary(std::string_view bytes) {
  constexpr std::size_t kBlock = VertexWelder::kMost / 3;
  MeshFile file;
  const std::size_t triangles = promised_triangles(bytes);
  resize_untouched(file.mesh.triangles, triangles);
  // A closed mesh of genus 0 has T / 2 + 2 vertices, by Euler's formula.
  VertexWelder welder(file.mesh.positions, triangles / 2 + 2);
  for (std::size_t first = 0; first < triangles; first += kBlock) {
    const std::size_t count = std::min(kBlock, triangles - first);
    std::array<Vec3d, 3 * kBlock> corners;
    std::array<std::uint32_t, 3 * kBlock> index;
    for (std::size_t i = 0; i < count; ++i) read_corners(bytes, first + i, &corners[3 * i]);
    welder.index({corners.data(), 3 * count}, {index.data(), 3 * count});
    std::memcpy(&file.mesh.triangles[first], index.data(), count * sizeof(Triangle));
  }
  note_welding(file, triangles);
  return file;
}

// Reads the text form line by line. A facet has one loop ("outer loop" ... "endloop") of vertices,
// usually three; more become a polygon. Keywords may be in capitals. A file may hold several
// solids, which become one mesh.
class AsciiReader {
 public:
  explicit AsciiReader(std::string_view text) : in_(text), welder_(file_.mesh.positions) {}

  MeshFile read() {
    for (; !in_.at_end(); in_.next_line()) read_line();
    if (in_loop_) in_.fail("the file ends inside a facet");
    if (!ended_) in_.fail("the file ends without 'endsolid'; it was cut off");
    polygons_.finish(file_);
    note_welding(file_, file_.mesh.triangle_count());
    return std::move(file_);
  }

 private:
  void read_line() {
    const std::string keyword = lower_case(in_.word());
    if (keyword == "vertex") {
      if (!in_loop_) in_.fail("a vertex outside of a loop");
      const double x = in_.number();
      const double y = in_.number();
      polygon_.push_back(welder_.index({x, y, in_.number()}));
    } else if (keyword == "outer") {
      in_loop_ = true;
      polygon_.clear();
    } else if (keyword == "endloop") {
      in_loop_ = false;
      polygons_.add(file_.mesh, polygon_);
    } else if (keyword == "solid" || keyword == "endsolid") {
      ended_ = keyword == "endsolid";
    } else if (keyword != "facet" && keyword != "endfacet") {
      in_.fail(fmt::format("'{}' has no place in an STL file", keyword.substr(0, 24)));
    }
  }

  TextScanner in_;
  MeshFile file_;
  VertexWelder welder_;
  // Whether the scanner is between "outer loop" and "endloop", and whether the last of the lines
  // "solid" and "endsolid" was "endsolid".
  bool in_loop_ = false, ended_ = false;
  Polygons polygons_;
  std::vector<std::uint32_t> polygon_;  // vertices of the loop that is being read
};

// Whether the file begins with "solid", as every text file must.
bool begins_as_text(std::string_view bytes) {
  bytes = without_byte_order_mark(bytes);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && lower_case(bytes.substr(first, 5)) == "solid";
}

}  // namespace

namespace {

void write_text_stl(const MeshView& view, ByteSink& sink) {
  const IndexedMesh& mesh = view.mesh;
  const std::string begin = fmt::format("solid made by vdwmesh; {}\n", unit_text(view.scale));
  constexpr std::string_view kEnd = "endsolid\n";
  constexpr std::size_t kMostBytes = 12 * (RecordBytes::kMostPerNumber + 1) + 128;
  // An estimate: nine doubles of about 18 characters, three floats and the words.
  sink.expect(300 * mesh.triangle_count());
  sink.write(begin.data(), begin.size());
  write_records(sink, mesh.triangle_count(), kMostBytes, [&](RecordBytes& out, std::size_t t) {
    const auto write_point = [&out](std::string_view before, const auto& p) {
      out.text(before);
      for (int k = 0; k < 3; ++k) {
        out.character(' ');
        out.number(p[k]);
      }
      out.character('\n');
    };
    const auto [i, j, k] = mesh.triangles[t];
    const Vec3d a = view.position(i), b = view.position(j), c = view.position(k);
    write_point("facet normal", unit_normal(a, b, c));
    out.text("outer loop\n");
    for (const Vec3d* p : {&a, &b, &c}) write_point("vertex", *p);
    out.text("endloop\nendfacet\n");
  });
  sink.write(kEnd.data(), kEnd.size());
}

}  // namespace

void write_stl(const MeshView& view, ByteSink& sink, Warnings& warnings) {
  const IndexedMesh& mesh = view.mesh;
  if (view.encoding == MeshEncoding::text) return write_text_stl(view, sink);
  sink.expect(kFirstTriangle + kTriangleSize * mesh.triangle_count());
  ChunkWriter out(sink);
  std::string header = fmt::format("binary STL made by vdwmesh; {}", unit_text(view.scale));
  header.resize(kHeaderSize);
  out.text(header);
  out.raw(static_cast<std::uint32_t>(mesh.triangle_count()));
  FloatLoss loss(view.scale);
  std::uint64_t collapsed = 0;  // triangles with two corners that become equal as floats
  for (std::size_t f = 0; f < mesh.triangle_count(); ++f) {
    const auto [i, j, k] = mesh.triangles[f];
    const Vec3d a = view.position(i), b = view.position(j), c = view.position(k);
    out.begin_record();
    out.raw(unit_normal(a, b, c));
    const std::array<Vec3f, 3> rounded{loss.round(a), loss.round(b), loss.round(c)};
    out.raw(rounded);
    out.raw(std::uint16_t{0});
    collapsed += rounded[0] == rounded[1] || rounded[1] == rounded[2] || rounded[2] == rounded[0];
  }
  loss.finish("STL", warnings);
  if (collapsed > 0)
    warnings.push_back(
        fmt::format("in STL's float32, corners of {} triangles fall together, so the "
                    "welded mesh may not be the same; the other formats keep it",
                    collapsed));
  out.flush();
}

// Decides between the two forms. Some programs write binary files that begin with "solid", so the
// first word is no proof. A file whose size agrees with the number of triangles at byte 80 is
// binary. If it does not agree, "solid" means text. Otherwise the file is binary: an error if it is
// too short, and a note if other bytes follow.
MeshFile read_stl(std::string_view bytes) {
  const bool has_count = bytes.size() >= kFirstTriangle;
  const std::size_t wanted =
      has_count ? kFirstTriangle + kTriangleSize * std::size_t{promised_triangles(bytes)} : 0;
  if (has_count && bytes.size() == wanted) return read_binary(bytes);
  if (begins_as_text(bytes)) {
    const PlainText text(bytes);
    return AsciiReader(text.view()).read();
  }
  if (!has_count)
    throw FileFormatError(
        fmt::format("byte {}: too short for a binary STL file, and no 'solid'", bytes.size()));
  if (bytes.size() < wanted)
    throw FileFormatError(
        fmt::format("byte {}: {} triangles are promised, but {} bytes are left "
                    "for them",
                    kHeaderSize, promised_triangles(bytes), bytes.size() - kFirstTriangle));
  MeshFile file = read_binary(bytes);
  file.notes.push_back(
      fmt::format("{} bytes after the last triangle were left out", bytes.size() - wanted));
  return file;
}

}  // namespace vdwmesh::formats
