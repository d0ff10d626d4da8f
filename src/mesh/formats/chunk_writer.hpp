// A write buffer between the writers of mesh files and a ByteSink, so that the sink gets few large
// writes.
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

#include "core/buffer.hpp"
#include "mesh/formats/output_file.hpp"
#include "mesh/formats/record_writer.hpp"

namespace vdwmesh::formats {

static_assert(std::endian::native == std::endian::little,
              "binary formats are written as in memory");

// The code that writes a format calls begin_record() before each vertex, face or other short
// record. What it appends until the next record is not checked against the end of the buffer:
// begin_record() has made room.
class ChunkWriter : public RecordBytes {
 public:
  explicit ChunkWriter(ByteSink& sink) : RecordBytes(nullptr), sink_(sink), buffer_(kSize) {
    end_ = buffer_.data();
  }

  // Makes room for the next kMostPerRecord bytes. A record must not be longer.
  void begin_record() {
    if (end_ + kMostPerRecord > buffer_.data() + kSize) flush();
  }
  // Writes text of any length, after what is in the buffer. The buffer is empty afterwards.
  void text(std::string_view s) {
    flush();
    sink_.write(s.data(), s.size());
  }
  // Hands the buffer over to the sink. Every writer must call it at the end.
  void flush() {
    sink_.write(buffer_.data(), static_cast<std::size_t>(end_ - buffer_.data()));
    end_ = buffer_.data();
  }

 private:
  static constexpr std::size_t kSize = std::size_t{1} << 18;  // stays in the second-level cache
  // Bytes. The longest record is a face of an OBJ file: six indices of up to 10 digits.
  static constexpr std::size_t kMostPerRecord = 512;

  ByteSink& sink_;
  Buffer<char> buffer_;
};

}  // namespace vdwmesh::formats
