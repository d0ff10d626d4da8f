// Asks the kernel about memory: what is available, and what the limits of the process's control
// groups leave. If a file of /proc or /sys/fs/cgroup is missing, as in some containers, its limit
// does not count.
#include "request/memory_limit.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "extract/extractor.hpp"

namespace vdwmesh {
namespace {

// MemAvailable of /proc/meminfo, which is in KiB.
std::optional<std::uint64_t> available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string key;
  std::uint64_t kibibytes = 0;
  for (std::string rest; file >> key >> kibibytes; std::getline(file, rest)) {
    if (key == "MemAvailable:") return kibibytes * 1024;
  }
  return std::nullopt;
}

// Returns the number in a file, or nothing if the file does not exist or says "max" (no limit).
std::optional<std::uint64_t> read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::uint64_t bytes = 0;
  if (!(file >> bytes)) return std::nullopt;
  return bytes;
}

// The lowest limit from a cgroup up to the root of its tree.
std::optional<std::uint64_t> lowest_limit(const std::filesystem::path& root, std::string group,
                                          const char* file) {
  std::optional<std::uint64_t> lowest;
  for (;;) {
    const auto limit = read_bytes(std::filesystem::path(root.string() + group) / file);
    if (limit && (!lowest || *limit < *lowest)) lowest = limit;
    if (group.empty() || group == "/") return lowest;
    group.resize(group.rfind('/'));
  }
}

}  // namespace

std::optional<std::uint64_t> cgroup_limit(std::istream& groups, const std::filesystem::path& root) {
  std::optional<std::uint64_t> lowest;
  for (std::string line; std::getline(groups, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    std::optional<std::uint64_t> limit;
    if (controllers.empty()) limit = lowest_limit(root, group, "memory.max");
    if (controllers == "memory") {
      limit = lowest_limit(root / "memory", group, "memory.limit_in_bytes");
    }
    if (limit && (!lowest || *limit < *lowest)) lowest = limit;
  }
  return lowest;
}

// A fifth of the memory that is there is left free.
std::uint64_t default_memory_limit(std::uint64_t processes) {
  std::ifstream groups("/proc/self/cgroup");
  const std::uint64_t least =
      std::min(available_memory().value_or(kNoMemoryLimit),
               cgroup_limit(groups, "/sys/fs/cgroup").value_or(kNoMemoryLimit));
  return least == kNoMemoryLimit ? kNoMemoryLimit : least / 5 * 4 / processes;
}

}  // namespace vdwmesh
