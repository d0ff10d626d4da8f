// A file that all ranks write at the same time, by MPI-IO.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "distributed/ranks.hpp"
#include "mesh/formats/output_file.hpp"

namespace vdwmesh {

struct OpenMpiFile;

// A hidden name for a SharedFile to `path`, in the same folder. All ranks know it before there is a
// file, so that each of them can remove it if the run is ended. Throws InvalidInput for a pipe or a
// device, which cannot be written from many places. Collective.
std::filesystem::path choose_hidden_name(const Ranks& ranks, const std::filesystem::path& path);

// The file appears under its name at commit(), whole, or not at all. Until then it has its hidden
// name, in a folder that all ranks must see. Throws FileFormatError, on all ranks where the
// function is collective.
class SharedFile {
 public:
  // Collective.
  SharedFile(const Ranks& ranks, const std::filesystem::path& path,
             const std::filesystem::path& hidden_name);
  // Removes the hidden file if there was no commit(). Collective.
  ~SharedFile();
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Writes bytes of this rank at a place of the file. Ranks must not write to the same place.
  void write_at(std::uint64_t offset, const char* data, std::size_t size);

  // Gives the complete file its name. Collective.
  void commit();

 private:
  void close();

  const Ranks& ranks_;
  std::filesystem::path path_;
  std::optional<OutputFile> own_;  // of the first rank: makes the hidden file and renames it
  std::unique_ptr<OpenMpiFile> handle_;
};

// A section of the file as a sink: the first write() goes to `offset`, each further one behind the
// one before.
class SharedFileSection : public ByteSink {
 public:
  SharedFileSection(SharedFile& file, std::uint64_t offset) : file_(file), next_(offset) {}
  void write(const char* data, std::size_t size) override {
    file_.write_at(next_, data, size);
    next_ += size;
  }

 private:
  SharedFile& file_;
  std::uint64_t next_;
};

}  // namespace vdwmesh
