// Where bytes of a file go while it is made.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>

#include "core/large_pages.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

class ByteSink {
 public:
  virtual ~ByteSink() = default;
  // About how much will be written.
  virtual void expect(std::size_t /*bytes*/) {}
  virtual void write(const char* data, std::size_t size) = 0;
};

class StringSink : public ByteSink {
 public:
  void expect(std::size_t bytes) override {
    bytes_.reserve(bytes);
    advise_large_pages(bytes_.data(), bytes);
  }
  void write(const char* data, std::size_t size) override { bytes_.append(data, size); }
  std::string take() && { return std::move(bytes_); }

 private:
  std::string bytes_;
};

// The file that writing to `path` replaces: the end of its symbolic links, also where nothing is
// there yet.
std::filesystem::path written_file(const std::filesystem::path& path);

// Whether `path` is a device, pipe or socket. Such a file takes the bytes as they come: nothing is
// replaced, and opening or writing may wait for a reader.
bool is_written_directly(const std::filesystem::path& path);

// A file that appears under its name whole, at commit(), or not at all: until then it has no name
// where the file system can do that (even a killed process leaves nothing), else a hidden one in
// the same directory. It takes the permissions of the file that it replaces. What
// is_written_directly() is not replaced. Every function throws FileFormatError that names the file
// and the system's reason.
class OutputFile : public ByteSink {
 public:
  enum class Staging { unnamed_where_possible, hidden };

  explicit OutputFile(const std::filesystem::path& path,
                      Staging staging = Staging::unnamed_where_possible);
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // From now on write() throws Cancelled once the monitor says so.
  void watch(const Monitor* monitor) { monitor_ = monitor; }
  void write(const char* data, std::size_t size) override;
  void commit();

 private:
  enum class Kind { unnamed, hidden, direct };
  void open_unnamed();
  void open_hidden();
  void link_unnamed();
  void take_permissions();
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_, target_;  // as given; links followed
  std::filesystem::path hidden_;
  Kind kind_ = Kind::unnamed;
  int descriptor_ = -1;
  const Monitor* monitor_ = nullptr;
};

}  // namespace vdwmesh
