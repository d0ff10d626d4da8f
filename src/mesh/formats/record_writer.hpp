// write_records(): the records of a mesh file, its vertices or its faces, formatted on all cores
// and written in order; write_blocks(), by which blocks of them are packed as well.
//
// A pipeline of three steps works on blocks of records. The first deals out blocks in their order,
// the second formats them into buffers, several at a time, and the third hands the buffers over to
// the sink, one after the other in their order. Writing thus waits for formatting only if one core
// formats slower than the system takes the bytes. The bytes do not depend on the number of threads.
#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <string_view>

#include "core/buffer.hpp"
#include "mesh/formats/output_file.hpp"

namespace vdwmesh::formats {

// Appends values to memory that has room for them.
class RecordBytes {
 public:
  explicit RecordBytes(char* begin) : end_(begin) {}

  // Appends the bytes of the value as they are in memory, so little-endian.
  template <class T>
  void raw(const T& value) {
    std::memcpy(end_, &value, sizeof value);
    end_ += sizeof value;
  }
  void character(char c) { *end_++ = c; }
  void text(std::string_view characters) {
    std::memcpy(end_, characters.data(), characters.size());
    end_ += characters.size();
  }
  // Appends the fewest digits from which the same number is read back.
  template <class T>
  void number(T value) {
    end_ = std::to_chars(end_, end_ + kMostPerNumber, value).ptr;
  }
  char* end() const { return end_; }

  // Characters of a number at most. A double needs at most 24, as in -1.2345678901234567e-308.
  static constexpr std::ptrdiff_t kMostPerNumber = 32;

 protected:
  char* end_;  // end of what was appended
};

// Appends values as words of a line.
class RecordWords {
 public:
  explicit RecordWords(RecordBytes& out) : out_(&out) {}
  template <class T>
  void raw(const T& value) {
    if (!first_) out_->character(' ');
    first_ = false;
    out_->number(value);
  }

 private:
  RecordBytes* out_;
  bool first_ = true;
};

// Calls format(out, i) for every i in [0, count), which appends record i, at most `most_bytes`
// long, to `out`, a RecordBytes; then finish(block) for the text of each block of records, both
// from several threads at the same time. Gives what finish() returns to put(), block by block in
// the order of i; a view of the block is valid until put() returns. What one of them throws is
// thrown, after all threads have ended.
template <class Format, class Finish, class Put>
void write_blocks(std::size_t count, std::size_t most_bytes, const Format& format,
                  const Finish& finish, const Put& put) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 18;  // stays in the second-level cache
  const std::size_t per_block = std::max<std::size_t>(1, kBlockBytes / most_bytes);
  const std::size_t blocks = (count + per_block - 1) / per_block;
  // Blocks leave the pipeline in their order, so of the blocks within it no two have one buffer.
  const auto buffers = static_cast<std::size_t>(2 * tbb::this_task_arena::max_concurrency());
  const std::size_t buffer_bytes = per_block * most_bytes;
  Buffer<char> memory(std::min(buffers, blocks) * buffer_bytes);

  std::size_t next = 0;
  const auto deal = [&](tbb::flow_control& control) {
    if (next == blocks) control.stop();
    return next++;
  };
  const auto make = [&](std::size_t block) {
    char* const bytes = memory.data() + block % buffers * buffer_bytes;
    RecordBytes out(bytes);
    const std::size_t end = std::min(count, (block + 1) * per_block);
    for (std::size_t i = block * per_block; i < end; ++i) format(out, i);
    return finish(std::string_view(bytes, static_cast<std::size_t>(out.end() - bytes)));
  };
  using Block = decltype(make(std::size_t{}));
  // Isolated: while this thread waits, it takes no other work, which could be long.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_pipeline(
        buffers, tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, deal) &
                     tbb::make_filter<std::size_t, Block>(tbb::filter_mode::parallel, make) &
                     tbb::make_filter<Block, void>(tbb::filter_mode::serial_in_order, put));
  });
}

// The same, with the blocks as they are, for the sink.
template <class Format>
void write_records(ByteSink& sink, std::size_t count, std::size_t most_bytes,
                   const Format& format) {
  write_blocks(
      count, most_bytes, format, [](std::string_view block) { return block; },
      [&](std::string_view block) { sink.write(block.data(), block.size()); });
}

}  // namespace vdwmesh::formats
