// Files that appear whole or not at all. The bytes go into a file without a name (Linux's
// O_TMPFILE) or with a hidden name, in the directory of the target, hence on the same file system.
// commit() sets its permissions, links it under a hidden name if it has none, closes it and renames
// it to the target. rename() is atomic: other processes see either the old file or the whole new
// one.
#include "mesh/formats/output_file.hpp"

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
#include "core/monitor.hpp"

namespace vdwmesh {
namespace {

namespace fs = std::filesystem;

constexpr mode_t kMode = 0666;  // permissions of a new file, from which the system takes the umask

// A hidden name in the target's directory. It does not contain the target's name, which may be as
// long as the file system allows. Process id and serial number make it unique.
fs::path hidden_beside(const fs::path& target) {
  static std::atomic<unsigned> serial{0};
  return target.parent_path() / fmt::format(".vdwmesh-{}-{}.tmp", ::getpid(), serial++);
}

// Calls make(hidden name) with one name after the other until it does not fail with EEXIST. A name
// is taken if an earlier process of the same process id was killed and left its file. Returns the
// result of the last call, negative for an error, and puts its name into `name`.
template <class Make>
int make_hidden(const fs::path& target, fs::path& name, Make make) {
  constexpr int kAttempts = 1000;  // far more than killed processes can have left in practice
  int result = -1;
  for (int i = 0; i < kAttempts; ++i) {
    name = hidden_beside(target);
    result = make(name.c_str());
    if (result >= 0 || errno != EEXIST) break;
  }
  return result;
}

// Makes a file under a name that is free. Returns the descriptor, negative for an error.
int create(const char* name) {
  return ::open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
}

fs::path directory_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

}  // namespace

fs::path written_file(const fs::path& path) {
  constexpr int kMostLinks = 40;  // Linux follows no more either
  fs::path file = path;
  std::error_code error;
  for (int links = 0; links < kMostLinks && fs::is_symlink(file, error); ++links) {
    const fs::path next = fs::read_symlink(file, error);
    if (error) return path;
    file = file.parent_path() / next;  // operator/ returns `next` if that is an absolute path
  }
  return file;
}

fs::path free_hidden_name(const fs::path& path) {
  fs::path name;
  make_hidden(written_file(path), name, [](const char* free) {
    if (::access(free, F_OK) != 0) return 0;
    errno = EEXIST;
    return -1;
  });
  return name;
}

bool is_written_directly(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

OutputFile::OutputFile(const fs::path& path, Staging staging)
    : path_(path), target_(written_file(path)) {
  // open() gets the path as given, not target_: /dev/stdout, for one, leads to a link in /proc
  // whose text, such as "pipe:[1234]", is the name of no file.
  if (is_written_directly(path)) {
    kind_ = Kind::direct;
    descriptor_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be written");
    return;
  }
  check_target();
  replaces_ = ::access(target_.c_str(), F_OK) == 0;
  if (staging == Staging::unnamed_where_possible) open_unnamed();
  if (descriptor_ < 0) open_hidden();
}

OutputFile::OutputFile(const fs::path& path, const fs::path& hidden_name)
    : path_(path), target_(written_file(path)), kind_(Kind::hidden) {
  check_target();
  descriptor_ = create(hidden_name.c_str());
  if (descriptor_ < 0) fail("cannot be written");
  hidden_ = hidden_name;
}

void OutputFile::check_target() const {
  std::error_code error;
  // If target_ is still a link, there were more than kMostLinks, so the links form a loop.
  const bool is_folder = fs::is_directory(target_, error), is_loop = fs::is_symlink(target_, error);
  if (!is_folder && !is_loop) return;
  errno = is_folder ? EISDIR : ELOOP;
  fail("cannot be written");
}

// Opens a file without a name, if the kernel and the file system can do that (O_TMPFILE,
// Linux 3.11). Leaves descriptor_ negative if not. link_unnamed() will need /proc.
void OutputFile::open_unnamed() {
#ifdef O_TMPFILE
  if (::access("/proc/self/fd", X_OK) == 0)
    descriptor_ = ::open(directory_of(target_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kMode);
#endif
}

void OutputFile::open_hidden() {
  kind_ = Kind::hidden;
  fs::path name;
  descriptor_ = make_hidden(target_, name, create);
  if (descriptor_ < 0) fail("cannot be written");
  hidden_ = name;
}

// Without a commit(), an unnamed file vanishes when it is closed, and a hidden one is removed.
// After commit() there is nothing left to close or remove.
OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
}

void OutputFile::write(const char* data, std::size_t size) {
  // Bytes per system call. A running call cannot be cancelled, so the monitor is asked between
  // calls.
  constexpr std::size_t kMost = std::size_t{1} << 24;
  while (size > 0) {
    if (monitor_ && monitor_->cancelled()) throw Cancelled("stopped on request");
    const ssize_t written = ::write(descriptor_, data, std::min(size, kMost));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("cannot be written in full");
    data += written;
    size -= static_cast<std::size_t>(written);
    begin_writing_back(static_cast<std::size_t>(written));
  }
}

// A rename() that replaces a file waits on some file systems (ext4) until all of the new file is on
// its way to the disk, so that after a power failure there is the old file or the new one. Most of
// that time is saved if the bytes are sent there as they come. The call does not wait for them,
// unless the disk has more to do than it takes at once. A system may not know the call, or not for
// this kind of file, which does not matter; but where a file system finds room for bytes only when
// it sends them, the call may be the only one that says that there is none.
void OutputFile::begin_writing_back([[maybe_unused]] std::size_t size) {
#ifdef SYNC_FILE_RANGE_WRITE
  constexpr std::uint64_t kAtOnce = std::uint64_t{1} << 23;  // bytes
  written_ += size;
  if (!replaces_ || written_ - written_back_ < kAtOnce) return;
  const int sent =
      ::sync_file_range(descriptor_, static_cast<off64_t>(written_back_),
                        static_cast<off64_t>(written_ - written_back_), SYNC_FILE_RANGE_WRITE);
  const bool is_lost = sent != 0 && (errno == EIO || errno == ENOSPC || errno == EDQUOT);
  if (is_lost) fail("cannot be written in full");
  written_back_ = written_;
#endif
}

// Gives the unnamed file a hidden name. linkat() cannot replace an existing file, so the file
// cannot get its final name at once; the rename() in commit() can replace one.
void OutputFile::link_unnamed() {
  fs::path name;
  const std::string self = fmt::format("/proc/self/fd/{}", descriptor_);
  const int linked = make_hidden(target_, name, [&](const char* free) {
    return ::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, free, AT_SYMLINK_FOLLOW);
  });
  if (linked != 0) fail("cannot be given its name");
  hidden_ = name;
}

// Copies the permissions of the file that is replaced, so that a private file stays private. An
// error of fchmod() is ignored: it means that the file system has no permissions to lose.
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

// Reports errno, so nothing may be called between the failure and fail().
void OutputFile::fail(const char* what) const {
  const std::string reason = std::generic_category().message(errno);
  throw FileFormatError(fmt::format("{} {}: {}", path_.string(), what, reason));
}

}  // namespace vdwmesh
