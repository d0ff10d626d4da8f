// Bytes and text collected into large writes.
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/buffer.hpp"
#include "mesh/output_file.hpp"
#include "mesh/surface_mesh.hpp"

namespace vdwmesh::formats {

static_assert(std::endian::native == std::endian::little,
              "binary formats are written as in memory");

class ChunkWriter {
 public:
  explicit ChunkWriter(ByteSink& sink) : sink_(sink), buffer_(kSize), end_(buffer_.data()) {}

  // Room for one record, at most kMostPerRecord bytes; what follows must fit in it.
  void begin_record() {
    if (end_ + kMostPerRecord > buffer_.data() + kSize) flush();
  }
  template <class T>
  void raw(const T& value) {
    std::memcpy(end_, &value, sizeof value);
    end_ += sizeof value;
  }
  void character(char c) { *end_++ = c; }
  // The shortest digits that read back the same number.
  template <class T>
  void number(T value) {
    end_ = std::to_chars(end_, end_ + kMostPerNumber, value).ptr;
  }
  void text(std::string_view s) {
    flush();
    sink_.write(s.data(), s.size());
  }
  void flush() {
    sink_.write(buffer_.data(), static_cast<std::size_t>(end_ - buffer_.data()));
    end_ = buffer_.data();
  }

 private:
  static constexpr std::size_t kSize = std::size_t{1} << 18;  // stays in the second-level cache
  static constexpr std::size_t kMostPerRecord = 512;
  static constexpr std::ptrdiff_t kMostPerNumber = 32;

  ByteSink& sink_;
  Buffer<char> buffer_;
  char* end_;
};

// Vertices of a face, first the one its half-edge starts from.
inline std::array<std::uint32_t, 3> face_vertices(const SurfaceMesh& mesh, std::size_t face) {
  const auto h = mesh.halfedge_handle(OpenMesh::FaceHandle(static_cast<int>(face)));
  const auto index = [&](OpenMesh::HalfedgeHandle to) {
    return static_cast<std::uint32_t>(mesh.to_vertex_handle(to).idx());
  };
  return {index(mesh.prev_halfedge_handle(h)), index(h), index(mesh.next_halfedge_handle(h))};
}

inline OpenMesh::VertexHandle vertex_handle(std::size_t v) {
  return OpenMesh::VertexHandle(static_cast<int>(v));
}

}  // namespace vdwmesh::formats
