// Writes results. Whether a file can be written is asked before the work begins, which may take
// hours; what cannot be foreseen, such as a full disk, is an error when it happens. Signals wait
// while a file is being written, so that no half of one is left.
#include "report/output.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <optional>
#include <system_error>

#include "core/errors.hpp"
#include "interrupt.hpp"
#include "mesh/formats/output_file.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

// What is there, links followed. Throws where the system cannot say: a name that is too long, a
// folder that may not be entered.
fs::file_status status_of(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::none) throw InvalidInput(error.message());
  return status;
}

// In a sticky folder (/tmp) a file can be replaced by its owner, the folder's and root alone.
bool sticky_folder_protects(const fs::path& file, const fs::path& folder) {
  struct stat of_file {
  }, of_folder{};
  if (::stat(file.c_str(), &of_file) != 0 || ::stat(folder.c_str(), &of_folder) != 0) return false;
  const uid_t user = ::geteuid();
  return (of_folder.st_mode & S_ISVTX) != 0 && user != 0 && user != of_file.st_uid &&
         user != of_folder.st_uid;
}

// Files are written beside their name and renamed, so that it is the folder that must be writable.
void check_folder(const fs::path& folder) {
  if (!fs::is_directory(status_of(folder))) {
    throw InvalidInput(fmt::format("there is no folder {}; make it first", folder.string()));
  }
  refuse_if(::access(folder.c_str(), W_OK | X_OK) != 0, "no permission to write into {}",
            folder.string());
}

// What can be asked without writing: permissions may change, and a disk may fill up, before the
// file is written.
void check_writable(const fs::path& path) {
  const fs::file_status status = status_of(path);
  if (fs::is_directory(status)) throw InvalidInput("is a folder; name a file in it");
  if (is_written_directly(path)) return;
  const fs::path file = written_file(path);
  check_folder(folder_of(file));
  if (!fs::exists(status)) return;
  if (::access(file.c_str(), W_OK) != 0 || sticky_folder_protects(file, folder_of(file))) {
    throw InvalidInput("no permission to replace the file that is there; name another");
  }
}

}  // namespace

void check_writable(std::string_view option, const fs::path& path) {
  try {
    check_writable(path);
  } catch (const InvalidInput& error) {
    refuse("{} {}: {}", option, path.string(), error.what());
  }
}

void write_whole(const fs::path& path, const std::function<void()>& write) {
  std::optional<HoldSignals> hold;
  if (!is_written_directly(path)) hold.emplace();
  write();
}

void write_file(const fs::path& path, std::string_view content) {
  write_whole(path, [&] {
    OutputFile file(path);
    const SignalMonitor signals;
    file.watch(&signals);
    file.write(content.data(), content.size());
    file.commit();
  });
}

void write_standard_output(std::string_view content) {
  const bool written = std::fwrite(content.data(), 1, content.size(), stdout) == content.size();
  if (written && std::fflush(stdout) == 0) return;
  throw FileFormatError(fmt::format("standard output: cannot be written: {}",
                                    std::generic_category().message(errno)));
}

void write_output(const std::string& where, std::string_view content) {
  if (where.empty()) return;
  if (where == "-") return write_standard_output(content);
  write_file(where, content);
}

}  // namespace vdwmesh::apps
