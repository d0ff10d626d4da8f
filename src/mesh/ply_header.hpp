// The header of a PLY file (Turk, "The PLY Polygon File Format", 1994).
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

std::size_t size_of(PlyScalar scalar);

struct PlyProperty {
  std::string name;
  PlyScalar type;
  std::optional<PlyScalar> list_count;  // type of the count before a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  // Bytes of an element in a binary file, its lists empty.
  std::size_t least_size() const;
};

struct PlyHeader {
  PlyEncoding encoding;
  std::vector<PlyElement> elements;
  std::size_t size;  // bytes up to and with the end_header line
};

// Throws FileFormatError with the line.
PlyHeader read_ply_header(std::string_view bytes);

}  // namespace vdwmesh::formats
