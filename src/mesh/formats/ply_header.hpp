// The header of a PLY file (Turk, "The PLY Polygon File Format", 1994). It is text and lists the
// elements of the body (such as "vertex" and "face"): how many there are, and of which properties
// each is made. A property is one number or a list of numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh::formats {

enum class PlyScalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
enum class PlyEncoding { ascii, little_endian, big_endian };

// Bytes of one number in a binary body.
std::size_t size_of(PlyScalar scalar);

struct PlyProperty {
  std::string name;
  PlyScalar type;
  std::optional<PlyScalar> list_count;  // for lists: type of the count before the numbers
};

struct PlyElement {
  std::string name;
  std::uint64_t count;  // as the header claims; the body may be shorter
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  // Bytes that one element of a binary file has if all its lists are empty. Without lists, this is
  // the exact size.
  std::size_t least_size() const;
};

struct PlyHeader {
  PlyEncoding encoding;
  std::vector<PlyElement> elements;
  std::size_t size;  // bytes up to the end of the end_header line: where the body begins
};

// Reads the header at the beginning of `bytes`; the body is not looked at. Throws FileFormatError
// with the line of the error.
PlyHeader read_ply_header(std::string_view bytes);

}  // namespace vdwmesh::formats
