// Destinations for the bytes of a file: a string, or a file that appears only when it is complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

#include "core/large_pages.hpp"

namespace vdwmesh {

class Monitor;

// Interface through which the writers of mesh files give away their bytes.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  // A hint how many bytes will be written in all.
  virtual void expect(std::size_t /*bytes*/) {}
  virtual void write(const char* data, std::size_t size) = 0;
};

// Collects the bytes in memory.
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

// The file that an OutputFile to `path` replaces: symbolic links are followed to their end, even if
// no file is there yet.
std::filesystem::path written_file(const std::filesystem::path& path);

// Whether `path` is a device, pipe or socket. Bytes go straight into such a file: nothing is
// replaced, and opening or writing may block until there is a reader.
bool is_written_directly(const std::filesystem::path& path);

// A hidden name in the folder of an OutputFile to `path`, under which there is no file now.
std::filesystem::path free_hidden_name(const std::filesystem::path& path);

// A file that appears under its name at commit(), whole, or not at all. Until then it has no name,
// if the file system supports that: then even a killed process leaves nothing behind. Otherwise it
// has a hidden name in the same directory, which the destructor removes. The file takes the
// permissions of the file that it replaces. If is_written_directly(path), bytes go into that file
// at once. All functions but the destructor throw FileFormatError with the name of the file and the
// reason that the system gives.
class OutputFile : public ByteSink {
 public:
  // How the bytes are kept before commit(): `hidden` is for tests of the second way.
  enum class Staging { unnamed_where_possible, hidden };

  explicit OutputFile(const std::filesystem::path& path,
                      Staging staging = Staging::unnamed_where_possible);
  // The same with a hidden name that the caller knows beforehand, for other processes that write
  // into the file or remove it. Throws also if there is a file of this name.
  OutputFile(const std::filesystem::path& path, const std::filesystem::path& hidden_name);
  ~OutputFile() override;
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  // After this call, write() throws Cancelled as soon as `monitor` says so. Null: never.
  void watch(const Monitor* monitor) { monitor_ = monitor; }
  void write(const char* data, std::size_t size) override;
  // Completes the file and gives it its name. To be called once, after the last write().
  void commit();

 private:
  // `direct` is a file for which is_written_directly() holds.
  enum class Kind { unnamed, hidden, direct };
  void check_target() const;
  void open_unnamed();
  void open_hidden();
  void link_unnamed();
  void take_permissions();
  void begin_writing_back(std::size_t size);
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path path_, target_;  // the name as given; the file that is replaced
  std::filesystem::path hidden_;         // empty unless a file of this name has to be removed
  Kind kind_ = Kind::unnamed;
  int descriptor_ = -1;             // negative if no file is open
  bool replaces_ = false;           // whether there was a file when this one was opened
  std::uint64_t written_ = 0;       // bytes
  std::uint64_t written_back_ = 0;  // bytes whose way to the disk was begun
  const Monitor* monitor_ = nullptr;
};

}  // namespace vdwmesh
