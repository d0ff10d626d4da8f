// What all writers of GLB share: the numbers of the glTF 2.0 specification, the header and the
// chunks, and colours in linear light.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "mesh/formats/chunk_writer.hpp"

namespace vdwmesh::formats {

constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;  // component types
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;          // targets
constexpr int kTriangles = 4;                                             // mode
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2;                // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr std::uint32_t kHeaderSize = 12, kChunkHeaderSize = 8;
// Bytes per vertex or triangle. All are multiples of 4, as glTF demands of offsets and chunks, so
// the arrays need no padding between them.
constexpr std::uint64_t kVectorSize = 12, kColorSize = 8, kTriangleSize = 12;

// Pads the JSON with blanks to a multiple of 4 bytes, as the format demands.
inline std::string padded(std::string json) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  return json;
}

// Writes the header of the file, the whole JSON chunk and the header of the binary chunk, whose
// size is `binary`. A mesh without faces has no binary chunk.
inline void write_header(const std::string& json, std::uint64_t binary, ChunkWriter& out) {
  const auto json_size = static_cast<std::uint32_t>(json.size());
  const auto binary_chunk = static_cast<std::uint32_t>(binary > 0 ? kChunkHeaderSize + binary : 0);
  out.begin_record();
  out.raw(kMagic);
  out.raw(kVersion);
  out.raw(kHeaderSize + kChunkHeaderSize + json_size + binary_chunk);
  out.raw(json_size);
  out.raw(kJsonChunk);
  out.text(json);
  if (binary == 0) return;
  out.raw(static_cast<std::uint32_t>(binary));
  out.raw(kBinaryChunk);
}

// The linear value of a byte of sRGB (IEC 61966-2-1), as glTF wants colours.
inline double linear_light(std::uint8_t byte) {
  const double s = static_cast<double>(byte) / 255;
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

}  // namespace vdwmesh::formats
