// Records that several threads format come out as one thread would write them, and what goes wrong
// on the way is thrown to the caller.
#include "mesh/formats/record_writer.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh::formats {
namespace {

constexpr std::size_t kMostBytes = 64;

// Records of 1 to 40 bytes, so that blocks differ in length.
std::string record(std::size_t i) {
  return std::to_string(i) + std::string(i * i % 31, static_cast<char>('a' + i % 26)) + '\n';
}

void append_record(RecordBytes& out, std::size_t i) {
  for (const char c : record(i)) out.character(c);
}

std::string written(std::size_t count) {
  StringSink sink;
  write_records(sink, count, kMostBytes, append_record);
  return std::move(sink).take();
}

TEST(WriteRecords, KeepsTheirOrderForAnyNumberOfThreads) {
  for (const std::size_t count : {0, 1, 4095, 4096, 4097, 300000}) {
    std::string expected;
    for (std::size_t i = 0; i < count; ++i) expected += record(i);
    for (const std::size_t threads : {1, 2, 7}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(written(count), expected) << count << " records, " << threads << " threads";
    }
  }
}

TEST(WriteRecords, AppendsBytesAndShortestNumbers) {
  StringSink sink;
  write_records(sink, 1, kMostBytes, [](RecordBytes& out, std::size_t) {
    out.raw(std::uint16_t{0x4241});  // "AB", least byte first
    out.number(0.1);
    out.character(' ');
    out.number(4294967295u);
  });
  EXPECT_EQ(std::move(sink).take(), "AB0.1 4294967295");
}

// A sink that is full after some bytes.
class FullSink : public ByteSink {
 public:
  void write(const char*, std::size_t size) override {
    written_ += size;
    if (written_ > 1000000) throw FileFormatError("no space left");
  }

 private:
  std::size_t written_ = 0;
};

TEST(WriteRecords, ThrowWhatTheSinkThrows) {
  FullSink sink;
  EXPECT_THROW(write_records(sink, 300000, kMostBytes, append_record), FileFormatError);
}

TEST(WriteRecords, ThrowWhatARecordThrows) {
  StringSink sink;
  const auto format = [](RecordBytes& out, std::size_t i) {
    if (i == 200000) throw LimitExceeded("too large");
    append_record(out, i);
  };
  EXPECT_THROW(write_records(sink, 300000, kMostBytes, format), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh::formats
