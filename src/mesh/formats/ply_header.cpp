// Parses the header of a PLY file, line by line: a keyword, then its arguments. An "element" line
// begins a new element, and the "property" lines that follow describe it. read_ply() calls this and
// then reads the body, whose layout the header gives.
#include "mesh/formats/ply_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mesh/formats/text_scanner.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::size_t kMostShown = 24;  // characters of a word in a message

// Both sets of names are in use: the original ones (char, uchar, ...) and those with sizes.
PlyScalar scalar_named(TextScanner& in, std::string_view name) {
  static constexpr std::pair<std::string_view, PlyScalar> kNames[] = {
      {"char", PlyScalar::int8},      {"int8", PlyScalar::int8},
      {"uchar", PlyScalar::uint8},    {"uint8", PlyScalar::uint8},
      {"short", PlyScalar::int16},    {"int16", PlyScalar::int16},
      {"ushort", PlyScalar::uint16},  {"uint16", PlyScalar::uint16},
      {"int", PlyScalar::int32},      {"int32", PlyScalar::int32},
      {"uint", PlyScalar::uint32},    {"uint32", PlyScalar::uint32},
      {"float", PlyScalar::float32},  {"float32", PlyScalar::float32},
      {"double", PlyScalar::float64}, {"float64", PlyScalar::float64}};
  for (const auto& [known, scalar] : kNames)
    if (known == name) return scalar;
  in.fail(fmt::format("'{}' is no PLY type", name.substr(0, kMostShown)));
}

// The rest of a "format" line. Its version is not read: there is only 1.0.
PlyEncoding read_format(TextScanner& in) {
  const std::string_view name = in.word();
  if (name == "ascii") return PlyEncoding::ascii;
  if (name == "binary_little_endian") return PlyEncoding::little_endian;
  if (name == "binary_big_endian") return PlyEncoding::big_endian;
  in.fail(fmt::format("'{}' is no PLY format", name.substr(0, kMostShown)));
}

// The rest of a "property" line: "type name", or "list count-type type name".
PlyProperty read_property(TextScanner& in) {
  PlyProperty property{};
  std::string_view type = in.word();
  if (type == "list") {
    property.list_count = scalar_named(in, in.word());
    // In the order of PlyScalar, integers come before floating-point types.
    if (*property.list_count >= PlyScalar::float32)
      in.fail("the count of a list is a whole number");
    type = in.word();
  }
  property.type = scalar_named(in, type);
  property.name = in.word();
  if (property.name.empty()) in.fail("a property without a name");
  return property;
}

}  // namespace

std::size_t size_of(PlyScalar scalar) {
  // In the order of PlyScalar.
  static constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(scalar)];
}

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& p) { return p.list_count.has_value(); });
}

std::size_t PlyElement::least_size() const {
  std::size_t size = 0;
  for (const PlyProperty& p : properties) size += size_of(p.list_count.value_or(p.type));
  return size;
}

PlyHeader read_ply_header(std::string_view bytes) {
  TextScanner in(bytes);
  if (in.word() != "ply") in.fail("a PLY file begins with 'ply'");
  PlyHeader header{};
  bool has_format = false;
  for (;;) {
    in.next_line();  // the rest of a line does not matter
    if (in.bytes_left() == 0) in.fail("the file ends before end_header");
    const std::string_view keyword = in.word();
    if (keyword == "end_header") break;
    // Comments are free text and may hold what looks like a keyword.
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      header.encoding = read_format(in);
      has_format = true;
    } else if (keyword == "element") {
      const std::string name(in.word());
      // No properties yet: the lines that follow append them.
      header.elements.push_back({name, in.integer<std::uint64_t>(), {}});
    } else if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(read_property(in));
    } else {
      in.fail(fmt::format("'{}' has no place in a PLY header", keyword.substr(0, kMostShown)));
    }
  }
  if (!has_format) in.fail("the header names no format");
  in.next_line();  // the body begins after the line feed that ends this line
  header.size = bytes.size() - in.bytes_left();
  return header;
}

}  // namespace vdwmesh::formats
