// SharedFile: the first rank makes a hidden file as every output file is made, and all ranks open
// it through MPI-IO. Offsets are explicit, no views of the file are set, and long arrays are
// written in pieces (pieces.hpp).
#include "distributed/files/shared_file.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <span>
#include <string>

#include "core/errors.hpp"
#include "distributed/shares/pieces.hpp"

namespace vdwmesh {
namespace {

// What MPI says of an error.
std::string reason_of(int error) {
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(error, text, &length);
  return {text, static_cast<std::size_t>(length)};
}

}  // namespace

struct OpenMpiFile {
  MPI_File file = MPI_FILE_NULL;
};

std::filesystem::path choose_hidden_name(const Ranks& ranks, const std::filesystem::path& path) {
  std::string name;
  ranks.together([&] {
    if (!ranks.is_first()) return;
    if (is_written_directly(path)) {
      throw InvalidInput(fmt::format(
          "{}: is a pipe or device, which many ranks cannot write; name a file", path.string()));
    }
    name = free_hidden_name(path).string();
  });
  std::vector<char> letters(name.begin(), name.end());
  ranks.share(letters);
  return std::string(letters.begin(), letters.end());
}

SharedFile::SharedFile(const Ranks& ranks, const std::filesystem::path& path,
                       const std::filesystem::path& hidden_name)
    : ranks_(ranks), path_(path), handle_(std::make_unique<OpenMpiFile>()) {
  ranks.together([&] {
    if (ranks.is_first()) own_.emplace(path, hidden_name);
  });
  const int error = MPI_File_open(MPI_COMM_WORLD, hidden_name.c_str(), MPI_MODE_WRONLY,
                                  MPI_INFO_NULL, &handle_->file);
  ranks.together([&] {
    if (error == MPI_SUCCESS) return;
    throw FileFormatError(
        fmt::format("{} cannot be opened by all ranks: {}; its folder must be "
                    "one that all hosts share",
                    path_.string(), reason_of(error)));
  });
}

SharedFile::~SharedFile() { close(); }

void SharedFile::close() {
  if (handle_->file != MPI_FILE_NULL) MPI_File_close(&handle_->file);
}

void SharedFile::write_at(std::uint64_t offset, const char* data, std::size_t size) {
  in_pieces(std::span(data, size), [&](const char* first, int count) {
    const auto place = static_cast<MPI_Offset>(offset) + (first - data);
    MPI_Status status;
    int written = 0;
    const int error = MPI_File_write_at(handle_->file, place, first, count, MPI_BYTE, &status);
    if (error == MPI_SUCCESS) MPI_Get_count(&status, MPI_BYTE, &written);
    if (written == count) return;
    throw FileFormatError(
        fmt::format("{} cannot be written in full: {}", path_.string(),
                    error == MPI_SUCCESS ? "no space left on device" : reason_of(error)));
  });
}

void SharedFile::commit() {
  const int error = MPI_File_close(&handle_->file);
  ranks_.together([&] {
    if (error == MPI_SUCCESS) return;
    throw FileFormatError(
        fmt::format("{} cannot be written in full: {}", path_.string(), reason_of(error)));
  });
  ranks_.together([&] {
    if (own_) own_->commit();
  });
}

}  // namespace vdwmesh
