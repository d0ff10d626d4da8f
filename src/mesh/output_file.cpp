#include "mesh/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <system_error>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kMode = 0666;  // less the umask

fs::path hidden_beside(const fs::path& target) {
  static std::atomic<unsigned> serial{0};
  return target.parent_path() /
         fmt::format(".{}.{}-{}.tmp", target.filename().string(), ::getpid(), serial++);
}

fs::path directory_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

}  // namespace

OutputFile::OutputFile(const fs::path& path, Staging staging) : path_(path), target_(path) {
  std::error_code ignored;
  if (fs::is_symlink(path, ignored)) {
    const fs::path followed = fs::weakly_canonical(path, ignored);
    if (!ignored) target_ = followed;
  }
  const fs::file_status status = fs::status(target_, ignored);
  if (fs::is_directory(status)) {
    errno = EISDIR;
    fail("cannot be written");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    kind_ = Kind::direct;
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be written");
    return;
  }
  if (staging == Staging::unnamed_where_possible) open_unnamed();
  if (descriptor_ < 0) open_hidden();
}

void OutputFile::open_unnamed() {
#ifdef O_TMPFILE
  if (::access("/proc/self/fd", X_OK) == 0)  // link_unnamed() needs it
    descriptor_ = ::open(directory_of(target_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
#endif
}

void OutputFile::open_hidden() {
  kind_ = Kind::hidden;
  hidden_ = hidden_beside(target_);
  descriptor_ = ::open(hidden_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  if (descriptor_ >= 0) return;
  hidden_.clear();
  fail("cannot be written");
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
}

void OutputFile::write(const char* data, std::size_t size) {
  constexpr std::size_t kMost = std::size_t{1} << 24;  // of one system call, which nothing stops
  while (size > 0) {
    if (monitor_ && monitor_->cancelled()) throw Cancelled("stopped on request");
    const ssize_t written = ::write(descriptor_, data, std::min(size, kMost));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("cannot be written in full");
    data += written;
    size -= static_cast<std::size_t>(written);
  }
}

// A name can only be given to an unnamed file where there is none, hence the step in between.
void OutputFile::link_unnamed() {
  const fs::path name = hidden_beside(target_);
  const std::string self = fmt::format("/proc/self/fd/{}", descriptor_);
  if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0)
    fail("cannot be given its name");
  hidden_ = name;
}

void OutputFile::commit() {
  if (kind_ == Kind::unnamed) link_unnamed();
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (closed != 0) fail("cannot be written in full");
  if (kind_ == Kind::direct) return;
  if (std::rename(hidden_.c_str(), target_.c_str()) != 0) fail("cannot be given its name");
  hidden_.clear();
}

void OutputFile::fail(const char* what) const {
  const std::string reason = std::generic_category().message(errno);
  throw FileFormatError(fmt::format("{} {}: {}", path_.string(), what, reason));
}

}  // namespace vdwmesh
