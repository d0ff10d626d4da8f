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

// A name of its own, because the target's may be as long as the file system allows.
fs::path hidden_beside(const fs::path& target) {
  static std::atomic<unsigned> serial{0};
  return target.parent_path() / fmt::format(".vdwmesh-{}-{}.tmp", ::getpid(), serial++);
}

// Calls `make` with hidden names until one is free: an earlier process with our number may have
// been killed and left its file. Returns what the last call did; its name is in `name`.
template <class Make>
int make_hidden(const fs::path& target, fs::path& name, Make make) {
  constexpr int kAttempts = 1000;
  int result = -1;
  for (int i = 0; i < kAttempts; ++i) {
    name = hidden_beside(target);
    result = make(name.c_str());
    if (result >= 0 || errno != EEXIST) break;
  }
  return result;
}

fs::path directory_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

}  // namespace

fs::path written_file(const fs::path& path) {
  constexpr int kMostLinks = 40;  // that Linux follows
  fs::path file = path;
  std::error_code error;
  for (int links = 0; links < kMostLinks && fs::is_symlink(file, error); ++links) {
    const fs::path next = fs::read_symlink(file, error);
    if (error) return path;
    file = file.parent_path() / next;  // which is `next` where that is absolute
  }
  return file;
}

bool is_written_directly(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

OutputFile::OutputFile(const fs::path& path, Staging staging)
    : path_(path), target_(written_file(path)) {
  // What a link in /proc stands for, as /dev/stdout does in a pipe, has no name to go by: it is
  // opened by the name it was given.
  if (is_written_directly(path)) {
    kind_ = Kind::direct;
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be written");
    return;
  }
  std::error_code error;
  const bool is_folder = fs::is_directory(target_, error), is_loop = fs::is_symlink(target_, error);
  if (is_folder || is_loop) {
    errno = is_folder ? EISDIR : ELOOP;
    fail("cannot be written");
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
  fs::path name;
  descriptor_ = make_hidden(target_, name, [](const char* free) {
    return ::open(free, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  });
  if (descriptor_ < 0) fail("cannot be written");
  hidden_ = name;
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
  fs::path name;
  const std::string self = fmt::format("/proc/self/fd/{}", descriptor_);
  const int linked = make_hidden(target_, name, [&](const char* free) {
    return ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, free, AT_SYMLINK_FOLLOW);
  });
  if (linked != 0) fail("cannot be given its name");
  hidden_ = name;
}

// A file that was private stays so. Not every file system can say permissions, and then none are
// lost.
void OutputFile::take_permissions() {
  struct stat replaced {};
  constexpr mode_t kPermissions = 0777;
  if (::stat(target_.c_str(), &replaced) == 0) [[maybe_unused]]
    const int ignored = ::fchmod(descriptor_, replaced.st_mode & kPermissions);
}

void OutputFile::commit() {
  if (kind_ != Kind::direct) take_permissions();
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
