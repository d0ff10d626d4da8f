// Unpacking: any bytes, and any bytes packed well.
#include <zlib.h>

#include <string>

#include "fuzz/memory_file.hpp"
#include "structure/read/text_source.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr std::uint64_t kLimit = std::uint64_t{1} << 20;

std::string packed(std::string_view text) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16, kMemory = 8;
  require(deflateInit2(&stream, 1, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) == Z_OK,
          "zlib starts");
  std::string bytes(deflateBound(&stream, text.size()), '\0');
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  require(deflate(&stream, Z_FINISH) == Z_STREAM_END, "zlib packs");
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

std::string unpacked(std::string_view bytes) {
  const Text text = read_text(MemoryFile(bytes).path(), kLimit);
  return {text.begin(), text.end()};
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = as_text(data, size);
  allow_refusal([&] { require(unpacked(bytes).size() <= kLimit, "the limit holds"); });
  if (size > kLimit / 2) return;
  const std::string once = packed(bytes);
  require(unpacked(once) == bytes, "what was packed comes back");
  require(unpacked(once + once) == std::string(bytes) + std::string(bytes),
          "members that were joined come back");
}

}  // namespace vdwmesh::fuzz
