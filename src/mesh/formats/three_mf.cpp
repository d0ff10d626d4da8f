// Writer of 3MF, the files of slicers for printers: XML with a unit, in a ZIP archive. A slicer
// takes 1 Å for 1 mm, as it does in STL. The archive has three members, packed by DEFLATE; its
// parts are those of APPNOTE.TXT 6.3, the model's those of the 3MF core specification 1.3.
#include <fmt/format.h>
#include <libdeflate.h>

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.hpp"
#include "mesh/formats/formats.hpp"
#include "mesh/formats/record_writer.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::string_view kTypes =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" "
    "ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" "
    "ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>\n";
constexpr std::string_view kRelations =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n";
constexpr std::string_view kModelBegin =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<model unit=\"millimeter\" xml:lang=\"en-US\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
    "<metadata name=\"Application\">vdwmesh</metadata>\n"
    "<resources>";
constexpr std::string_view kObjectEnd = "</triangles></mesh></object>";
constexpr std::string_view kModelEnd = "</build>\n</model>\n";

// An element whose attributes are numbers.
template <class Numbers>
void write_element(RecordBytes& out, std::string_view name,
                   const std::array<std::string_view, 3>& attributes, const Numbers& values) {
  const auto text = [&out](std::string_view characters) {
    for (const char c : characters) out.character(c);
  };
  text(name);
  for (std::size_t k = 0; k < attributes.size(); ++k) {
    text(attributes[k]);
    out.number(values[k]);
    out.character('"');
  }
  text("/>\n");
}

constexpr std::size_t kMostPerElement = 32 + 3 * (6 + RecordBytes::kMostPerNumber);

// Names have no characters that XML would have to write in another way.
void write_object(std::size_t id, const std::string& name, const IndexedMesh& mesh,
                  ByteSink& sink) {
  const auto write = [&sink](std::string_view text) { sink.write(text.data(), text.size()); };
  write(fmt::format("<object id=\"{}\" type=\"model\"", id));
  if (!name.empty()) write(fmt::format(" name=\"{}\"", name));
  write("><mesh><vertices>\n");
  write_records(sink, mesh.vertex_count(), kMostPerElement, [&](RecordBytes& out, std::size_t v) {
    const Vec3d& p = mesh.positions[v];
    write_element(out, "<vertex", {" x=\"", " y=\"", " z=\""}, std::array{p.x, p.y, p.z});
  });
  write("</vertices><triangles>\n");
  write_records(sink, mesh.triangle_count(), kMostPerElement, [&](RecordBytes& out, std::size_t t) {
    write_element(out, "<triangle", {" v1=\"", " v2=\"", " v3=\""}, mesh.triangles[t]);
  });
  write(kObjectEnd);
}

// An estimate: three doubles of about 18 characters per vertex, three 7-digit numbers per triangle.
std::size_t text_size(const IndexedMesh& mesh) {
  return 82 * mesh.vertex_count() + 52 * mesh.triangle_count();
}

// `write_all` writes `count` objects, which have the numbers from 1 on.
template <class WriteAll>
std::string model_text(std::size_t bytes, std::size_t count, const WriteAll& write_all) {
  StringSink sink;
  sink.expect(bytes);
  const auto write = [&sink](std::string_view text) { sink.write(text.data(), text.size()); };
  write(kModelBegin);
  write_all(sink);
  write("</resources>\n<build>");
  for (std::size_t id = 1; id <= count; ++id) write(fmt::format("<item objectid=\"{}\"/>", id));
  write(kModelEnd);
  return std::move(sink).take();
}

// Numbers of 16 and 32 bits, little-endian.
class Record {
 public:
  Record& u16(std::uint32_t value) { return bytes(value, 2); }
  Record& u32(std::uint32_t value) { return bytes(value, 4); }
  Record& text(std::string_view characters) {
    bytes_ += characters;
    return *this;
  }
  const std::string& get() const { return bytes_; }

 private:
  Record& bytes(std::uint32_t value, int count) {
    for (int k = 0; k < count; ++k) bytes_ += static_cast<char>(value >> (8 * k) & 0xffU);
    return *this;
  }
  std::string bytes_;
};

// Members one after another, then their directory.
class ZipWriter {
 public:
  explicit ZipWriter(ByteSink& sink) : sink_(sink) {}

  void add(std::string_view name, std::string_view content) {
    const std::string packed = pack(content);
    constexpr std::uint32_t kVersion = 20, kDeflate = 8, kFirstDay = 0x21;  // 1 January 1980
    Record facts;
    facts.u16(kVersion).u16(0).u16(kDeflate).u16(0).u16(kFirstDay);
    facts.u32(libdeflate_crc32(0, content.data(), content.size()));
    facts.u32(small(packed.size())).u32(small(content.size()));
    facts.u16(small(name.size())).u16(0);
    directory_.text("PK\1\2").u16(kVersion).text(facts.get()).u16(0).u16(0).u16(0).u32(0);
    directory_.u32(small(offset_)).text(name);
    ++members_;
    write(Record().text("PK\3\4").text(facts.get()).text(name).get());
    write(packed);
  }

  void end() {
    Record tail;
    tail.text("PK\5\6").u16(0).u16(0).u16(members_).u16(members_);
    tail.u32(small(directory_.get().size())).u32(small(offset_)).u16(0);
    write(directory_.get());
    write(tail.get());
  }

 private:
  static std::uint32_t small(std::uint64_t value) {
    if (value >= std::numeric_limits<std::uint32_t>::max())
      throw LimitExceeded("3MF holds 4 GB of text here; choose another format, or longer edges");
    return static_cast<std::uint32_t>(value);
  }

  static std::string pack(std::string_view content) {
    constexpr int kLevel = 6;
    const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
        libdeflate_alloc_compressor(kLevel), libdeflate_free_compressor);
    if (!compressor) throw std::bad_alloc();
    std::string packed(libdeflate_deflate_compress_bound(compressor.get(), content.size()), '\0');
    packed.resize(libdeflate_deflate_compress(compressor.get(), content.data(), content.size(),
                                              packed.data(), packed.size()));
    return packed;
  }

  void write(const std::string& bytes) {
    sink_.write(bytes.data(), bytes.size());
    offset_ += bytes.size();
  }

  ByteSink& sink_;
  Record directory_;
  std::uint64_t offset_ = 0;
  std::uint32_t members_ = 0;
};

void write_archive(const std::string& model, ByteSink& sink) {
  ZipWriter zip(sink);
  zip.add("[Content_Types].xml", kTypes);
  zip.add("_rels/.rels", kRelations);
  zip.add("3D/3dmodel.model", model);
  zip.end();
}

}  // namespace

void write_3mf(const MeshView& view, ByteSink& sink) {
  write_archive(model_text(text_size(view.mesh), 1,
                           [&](ByteSink& out) { write_object(1, "", view.mesh, out); }),
                sink);
}

void write_3mf(std::span<const NamedMesh> meshes, ByteSink& sink) {
  std::size_t bytes = 0;
  for (const NamedMesh& m : meshes) bytes += text_size(m.mesh);
  write_archive(model_text(bytes, meshes.size(),
                           [&](ByteSink& out) {
                             for (std::size_t i = 0; i < meshes.size(); ++i)
                               write_object(i + 1, meshes[i].name, meshes[i].mesh, out);
                           }),
                sink);
}

}  // namespace vdwmesh::formats
