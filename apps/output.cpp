#include "output.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/errors.hpp"
#include "interrupt.hpp"

namespace vdwmesh::apps {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void throw_cannot_write(const fs::path& path) {
  throw FileFormatError(
      fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno)));
}

// Writes to `path`; what goes wrong is told of `name`, which the caller knows.
void write_to(const fs::path& path, std::string_view content, const fs::path& name) {
  File file(std::fopen(path.c_str(), "wb"));
  if (!file) throw_cannot_write(name);
  const bool written = std::fwrite(content.data(), 1, content.size(), file.get()) == content.size();
  if (!written || std::fflush(file.get()) != 0) throw_cannot_write(name);
}

fs::path folder_of(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

bool is_special(const fs::path& path) {
  const fs::file_status status = fs::status(path);
  return fs::exists(status) && !fs::is_regular_file(status);
}

}  // namespace

void check_writable(std::string_view option, const fs::path& path) {
  if (fs::is_directory(path)) {
    throw InvalidInput(fmt::format("{} {}: is a folder; name a file in it", option, path.string()));
  }
  const fs::path folder = folder_of(path);
  if (!fs::is_directory(folder)) {
    throw InvalidInput(fmt::format("{} {}: there is no folder {}; make it first", option,
                                   path.string(), folder.string()));
  }
  if (!is_special(path) && ::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw InvalidInput(fmt::format("{} {}: no permission to write into {}", option, path.string(),
                                   folder.string()));
  }
}

void write_file(const fs::path& path, std::string_view content) {
  if (is_special(path)) return write_to(path, content, path);
  const HoldSignals hold;
  const fs::path temporary = path.string() + fmt::format(".{}.part", ::getpid());
  try {
    write_to(temporary, content, path);
    fs::rename(temporary, path);
  } catch (const std::exception&) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_standard_output(std::string_view content) {
  const bool written = std::fwrite(content.data(), 1, content.size(), stdout) == content.size();
  if (!written || std::fflush(stdout) != 0) throw_cannot_write("standard output");
}

}  // namespace vdwmesh::apps
