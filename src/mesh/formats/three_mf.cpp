// Writer of 3MF, the files of slicers for printers: XML with a unit, in a ZIP archive. A slicer
// takes 1 Å for 1 mm, as it does in STL, unless a scale is given. The archive has three members,
// packed by DEFLATE; its parts are those of APPNOTE.TXT 6.3, the model's those of the 3MF core
// specification 1.3.
//
// The text is packed block by block on all cores while it is written, and never in memory as a
// whole. A block ends at a whole byte and needs none before it, so packed blocks follow each other
// (M. Adler, pigz). Sizes and checksums, which are known last, stand behind each member.
#define ZLIB_CONST  // zlib then promises not to change what it packs
#include <fmt/format.h>
#include <zlib.h>

#include <array>
#include <limits>
#include <new>
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
    "<metadata name=\"Application\">vdwmesh</metadata>{}\n"
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

// Text that was packed up to a whole byte.
struct PackedBlock {
  std::string bytes;
  std::uint32_t checksum = 0;  // CRC-32 of the text
  std::size_t size = 0;        // of the text
};

PackedBlock pack(std::string_view text) {
  constexpr int kLevel = 4, kNoHeader = -15, kMemory = 8;  // twice as fast as level 6
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kNoHeader, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  constexpr std::size_t kMostOfFlush = 16;  // bytes of an empty block, and to spare
  std::string bytes(deflateBound(&stream, text.size()) + kMostOfFlush, '\0');
  const auto* const begin = reinterpret_cast<const Bytef*>(text.data());
  stream.next_in = begin;
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  deflate(&stream, Z_SYNC_FLUSH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  const uLong checksum = crc32(0, begin, static_cast<uInt>(text.size()));
  return {std::move(bytes), static_cast<std::uint32_t>(checksum), text.size()};
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

  void begin(std::string_view name) {
    name_ = name;
    start_ = offset_;
    whole_ = {};
    packed_ = 0;
    write(Record().text("PK\3\4").text(facts().get()).text(name).get());
  }

  // Throws LimitExceeded as soon as the text has 4 GB.
  void add(const PackedBlock& block) {
    whole_.checksum = static_cast<std::uint32_t>(
        crc32_combine(whole_.checksum, block.checksum, static_cast<z_off_t>(block.size)));
    whole_.size += block.size;
    small(whole_.size);
    packed_ += block.bytes.size();
    write(block.bytes);
  }

  // Behind the member: an empty last block of DEFLATE, and what is known now.
  void end_member() {
    constexpr std::string_view kLastBlock("\3\0", 2);
    add({std::string(kLastBlock), 0, 0});
    const Record known = facts();
    write(Record().text("PK\7\10").text(sizes().get()).get());
    directory_.text("PK\1\2").u16(kVersion).text(known.get()).u16(0).u16(0).u16(0).u32(0);
    directory_.u32(small(start_)).text(name_);
    ++members_;
  }

  void end() {
    Record tail;
    tail.text("PK\5\6").u16(0).u16(0).u16(members_).u16(members_);
    tail.u32(small(directory_.get().size())).u32(small(offset_)).u16(0);
    write(directory_.get());
    write(tail.get());
  }

 private:
  static constexpr std::uint32_t kVersion = 20;

  static std::uint32_t small(std::uint64_t value) {
    if (value >= std::numeric_limits<std::uint32_t>::max())
      throw LimitExceeded("3MF holds 4 GB of text here; choose another format, or longer edges");
    return static_cast<std::uint32_t>(value);
  }

  Record sizes() const {
    return Record().u32(whole_.checksum).u32(small(packed_)).u32(small(whole_.size));
  }

  // What the head of a member and the directory say alike. In the head, the sizes are still 0.
  Record facts() const {
    constexpr std::uint32_t kSizesBehind = 8, kDeflate = 8, kFirstDay = 0x21;  // 1 January 1980
    Record facts;
    facts.u16(kVersion).u16(kSizesBehind).u16(kDeflate).u16(0).u16(kFirstDay);
    return facts.text(sizes().get()).u16(small(name_.size())).u16(0);
  }

  void write(const std::string& bytes) {
    sink_.write(bytes.data(), bytes.size());
    offset_ += bytes.size();
  }

  ByteSink& sink_;
  Record directory_;
  std::uint64_t offset_ = 0;
  std::uint32_t members_ = 0;
  std::string name_;         // of the member that is being written
  std::uint64_t start_ = 0;  // where it begins
  PackedBlock whole_;        // its size and checksum so far
  std::uint64_t packed_ = 0;
};

// Elements with three attributes each, packed by all cores.
template <class Numbers>
void add_elements(ZipWriter& zip, std::size_t count, std::string_view name,
                  const std::array<std::string_view, 3>& attributes, const Numbers& numbers) {
  write_blocks(
      count, kMostPerElement,
      [&](RecordBytes& out, std::size_t i) { write_element(out, name, attributes, numbers(i)); },
      pack, [&](const PackedBlock& block) { zip.add(block); });
}

void add_member(ZipWriter& zip, std::string_view name, std::string_view text) {
  zip.begin(name);
  zip.add(pack(text));
  zip.end_member();
}

// Names have no characters that XML would have to write in another way.
void add_object(ZipWriter& zip, std::size_t id, const std::string& name, const MeshView& view) {
  const IndexedMesh& mesh = view.mesh;
  const std::string named = name.empty() ? "" : fmt::format(" name=\"{}\"", name);
  zip.add(pack(fmt::format("<object id=\"{}\" type=\"model\"{}><mesh><vertices>\n", id, named)));
  add_elements(zip, mesh.vertex_count(), "<vertex", {" x=\"", " y=\"", " z=\""},
               [&](std::size_t v) {
                 const Vec3d p = view.position(v);
                 return std::array{p.x, p.y, p.z};
               });
  zip.add(pack("</vertices><triangles>\n"));
  add_elements(zip, mesh.triangle_count(), "<triangle", {" v1=\"", " v2=\"", " v3=\""},
               [&](std::size_t t) { return mesh.triangles[t]; });
  zip.add(pack(kObjectEnd));
}

// add_objects() adds `count` objects, which have the numbers from 1 on.
template <class AddObjects>
void write_archive(std::size_t count, double scale, ByteSink& sink, const AddObjects& add_objects) {
  ZipWriter zip(sink);
  add_member(zip, "[Content_Types].xml", kTypes);
  add_member(zip, "_rels/.rels", kRelations);
  zip.begin("3D/3dmodel.model");
  const std::string unit =
      scale == 1 ? ""
                 : fmt::format("<metadata name=\"Description\">{}</metadata>", unit_text(scale));
  zip.add(pack(fmt::format(kModelBegin, unit)));
  add_objects(zip);
  std::string items = "</resources>\n<build>";
  for (std::size_t id = 1; id <= count; ++id) items += fmt::format("<item objectid=\"{}\"/>", id);
  zip.add(pack(items.append(kModelEnd)));
  zip.end_member();
  zip.end();
}

}  // namespace

void write_3mf(const MeshView& view, ByteSink& sink) {
  write_archive(1, view.scale, sink, [&](ZipWriter& zip) { add_object(zip, 1, "", view); });
}

void write_3mf(std::span<const NamedMesh> meshes, ByteSink& sink) {
  write_archive(meshes.size(), 1, sink, [&](ZipWriter& zip) {
    for (std::size_t i = 0; i < meshes.size(); ++i)
      add_object(zip, i + 1, meshes[i].name, {.mesh = meshes[i].mesh});
  });
}

}  // namespace vdwmesh::formats
