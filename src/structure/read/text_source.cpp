// Reads a file with POSIX calls and unpacks gzip with libdeflate or zlib.
//
// 1. read_bytes() reads the file in one piece. The size of a regular file is known beforehand; the
//    buffer for a pipe grows by doubling.
// 2. If the bytes begin with the magic number of gzip, unpack_at_once() tries libdeflate, which is
//    two to three times as fast as zlib but has to know the size of the text.
// 3. If that does not work, for whatever reason, Inflater unpacks the bytes in chunks with zlib. It
//    reads whatever gzip is, and its messages say what is wrong.
// All steps check the limit on bytes. A huge file, or a small file that unpacks to a huge text, is
// refused soon after the limit is passed.
#include "structure/read/text_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;  // bytes

// The best compression that the deflate format can reach. The longest match is 258 bytes, and it
// takes at least 2 bits (1 for the length code, 1 for the distance code): 258 * 8 / 2 = 1032.
constexpr std::size_t kLargestDeflateRatio = 1032;

// The most bytes of text that are unpacked in one go, during which nobody is asked whether to stop.
constexpr std::size_t kMostAtOnce = std::size_t{256} << 20;

std::string cause(int error) { return std::generic_category().message(error); }

// An open file descriptor, closed by the destructor. Descriptor 0 (standard input) stays open.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path)
      : owned_(path != "-"), fd_(owned_ ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC) : 0) {
    if (fd_ < 0)
      throw FileFormatError(fmt::format("{}: cannot be opened: {}", path.string(), cause(errno)));
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (owned_) ::close(fd_);
  }
  int get() const { return fd_; }

 private:
  bool owned_;
  int fd_;
};

[[noreturn]] void refuse_size(const std::filesystem::path& path, std::uint64_t limit) {
  throw LimitExceeded(fmt::format("{}: holds more than {:.1f} MiB of text, the most that is read{}",
                                  path.string(), static_cast<double>(limit) / 0x1p20,
                                  limit < kMaxTextBytes ? " in the memory allowed; allow more"
                                                        : "; cut it into smaller files"));
}

// The size of a regular file in bytes. 0 for pipes and devices, which have no size beforehand, and
// for the files of /proc, which claim to be empty.
std::uint64_t expected_size(int fd, const std::filesystem::path& path) {
  struct stat info {};
  if (::fstat(fd, &info) != 0) return 0;
  if (S_ISDIR(info.st_mode))
    throw FileFormatError(fmt::format("{}: is a directory, not a structure file", path.string()));
  return S_ISREG(info.st_mode) && info.st_size > 0 ? static_cast<std::uint64_t>(info.st_size) : 0;
}

Text read_bytes(const std::filesystem::path& path, std::uint64_t limit) {
  const Descriptor file(path);
  const std::uint64_t expected = expected_size(file.get(), path);  // 0: not known
  if (expected > limit) refuse_size(path, limit);
  Text bytes;
  // One byte more than the file has: the read() that finds the end of the file needs a free byte,
  // and the buffer must not be doubled for it.
  resize_untouched(bytes, static_cast<std::size_t>(expected) + 1);
  std::size_t used = 0;
  for (;;) {
    if (used == bytes.size()) bytes.resize(std::max(2 * bytes.size(), kChunk));
    const ssize_t got = ::read(file.get(), bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;  // a signal interrupted the call; try again
    if (got < 0)
      throw FileFormatError(fmt::format("{}: cannot be read: {}", path.string(), cause(errno)));
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > limit) refuse_size(path, limit);
  }
  if (expected > 0 && used != expected)
    throw FileFormatError(fmt::format(
        "{}: gave {} bytes where its size is {}: it changed while being read, so try again",
        path.string(), used, expected));
  bytes.resize(used);
  return bytes;
}

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

constexpr std::size_t kLeastGzip = 18;  // bytes: a header of 10 and a trailer of 8

// The size that gzip data claim to have once unpacked, and that deflate could have reached. gzip
// stores it modulo 2^32 in the last four bytes, lowest byte first. It may be wrong: the data may be
// damaged or have several members. 0 if it cannot be right, or is beyond the limit.
std::size_t claimed_size(std::string_view packed, std::uint64_t limit) {
  if (packed.size() < kLeastGzip) return 0;
  std::uint64_t size = 0;
  for (std::size_t i = 1; i <= 4; ++i)
    size = size << 8 | static_cast<unsigned char>(packed[packed.size() - i]);
  const std::uint64_t believable =
      std::min<std::uint64_t>(limit, std::uint64_t{packed.size()} * kLargestDeflateRatio);
  return size <= believable ? static_cast<std::size_t>(size) : 0;
}

// A first size for the buffer of the unpacked text. A wrong one costs time and memory, but never
// correctness: Inflater enlarges the buffer as needed.
std::size_t unpacked_size_hint(std::string_view packed, std::uint64_t limit) {
  const std::size_t size = claimed_size(packed, limit);
  return size > 0 ? size + 1 : kChunk;
}

// Unpacks gzip data of one member with its claimed size. Nothing if they are anything else, or
// damaged. libdeflate does not look at the checksum that a header may have, so such headers are
// not for it.
std::optional<Text> unpack_at_once(std::string_view packed, std::uint64_t limit) {
  constexpr unsigned char kHeaderHasChecksum = 2;  // a bit of the fourth byte
  const std::size_t size = claimed_size(packed, limit);
  if (size == 0 || size > kMostAtOnce) return std::nullopt;
  if ((static_cast<unsigned char>(packed[3]) & kHeaderHasChecksum) != 0) return std::nullopt;
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)>
      decompressor(libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) return std::nullopt;
  Text text;
  resize_untouched(text, size);
  std::size_t read = 0;
  // Without a place for the size it succeeds only if the text has exactly this size.
  const libdeflate_result result = libdeflate_gzip_decompress_ex(
      decompressor.get(), packed.data(), packed.size(), text.data(), text.size(), &read, nullptr);
  if (result != LIBDEFLATE_SUCCESS || read != packed.size()) return std::nullopt;
  return text;
}

// Unpacks gzip data. `path` serves the messages only.
class Inflater {
 public:
  explicit Inflater(const std::filesystem::path& path) : path_(path) {
    // 15: the largest window, so every stream can be read; + 16: with the header of gzip.
    if (inflateInit2(&stream_, 15 + 16) != Z_OK) fail("zlib could not start");
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  // `used` counts the bytes of text so far, `read` the bytes of `packed` that were consumed.
  Text unpack(std::string_view packed, std::uint64_t limit, Monitor* monitor) {
    Text text;
    resize_untouched(text, unpacked_size_hint(packed, limit));
    std::size_t used = 0, read = 0;
    for (;;) {
      advance(monitor, 0);
      if (used > limit) refuse_size(path_, limit);
      if (used == text.size()) text.resize(2 * text.size());
      const int status = step(packed, read, text, used);
      if (status != Z_STREAM_END) continue;
      if (!next_member(packed, read)) break;
    }
    if (used > limit) refuse_size(path_, limit);
    text.resize(used);
    return text;
  }

 private:
  // Unpacks at most one chunk and returns zlib's status: Z_OK, or Z_STREAM_END at the end of a
  // member. Moves `read` and `used` on. zlib counts in 32 bits; a chunk stays below that and lets
  // unpack() check the limit after every MiB.
  int step(std::string_view packed, std::size_t& read, Text& text, std::size_t& used) {
    const std::size_t in = std::min(packed.size() - read, kChunk);
    const std::size_t out = std::min(text.size() - used, kChunk);
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data() + read));
    stream_.avail_in = static_cast<uInt>(in);
    stream_.next_out = reinterpret_cast<Bytef*>(text.data() + used);
    stream_.avail_out = static_cast<uInt>(out);
    const int status = inflate(&stream_, Z_NO_FLUSH);
    read += in - stream_.avail_in;
    used += out - stream_.avail_out;
    // zlib made no progress, or it has no more input and wrote nothing: the data end too early.
    if (status == Z_BUF_ERROR || (status == Z_OK && in == 0 && stream_.avail_out == out))
      fail("ends in the middle of its gzip data; it was cut off, get it again");
    if (status != Z_OK && status != Z_STREAM_END) fail("holds damaged gzip data; get it again");
    return status;
  }

  // Prepares for the next member of the gzip file. Returns false if there is none. Files that were
  // joined with the program cat hold several members. Zeros after the last member are common
  // padding.
  bool next_member(std::string_view packed, std::size_t& read) {
    const auto rest = packed.begin() + static_cast<std::ptrdiff_t>(read);
    if (std::all_of(rest, packed.end(), [](char c) { return c == '\0'; })) return false;
    if (*rest != '\x1f') fail("holds something else after its gzip data; get it again");
    inflateReset(&stream_);
    return true;
  }

  [[noreturn]] void fail(const char* what) const {
    throw FileFormatError(fmt::format("{}: {}", path_.string(), what));
  }

  std::filesystem::path path_;
  z_stream stream_{};
};

Text unpacked(std::string_view packed, const std::filesystem::path& path, std::uint64_t limit,
              Monitor* monitor) {
  advance(monitor, 0);
  if (std::optional<Text> text = unpack_at_once(packed, limit)) return std::move(*text);
  return Inflater(path).unpack(packed, limit, monitor);
}

}  // namespace

Text read_text(const std::filesystem::path& path, std::uint64_t limit, Monitor* monitor) {
  Text bytes = read_bytes(path, limit);
  const std::string_view view(bytes.data(), bytes.size());
  if (!is_gzip(view)) return bytes;
  return unpacked(view, path, limit, monitor);
}

Text text_of(std::string_view bytes, const std::filesystem::path& name, std::uint64_t limit,
             Monitor* monitor) {
  if (is_gzip(bytes)) return unpacked(bytes, name, limit, monitor);
  if (bytes.size() > limit) refuse_size(name, limit);
  return Text(bytes.begin(), bytes.end());
}

}  // namespace vdwmesh
