// How much memory a request may take unless told otherwise.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <optional>

namespace vdwmesh {

// The lowest memory limit of the groups that a process is in and of those around them, in bytes.
// `groups`: lines of /proc/self/cgroup, "0::/path" (version 2) or "7:memory:/path" (version 1).
// `root` is /sys/fs/cgroup, but in tests. Nothing if no group has a limit.
std::optional<std::uint64_t> cgroup_limit(std::istream& groups, const std::filesystem::path& root);

// 80 % of the least of the available memory and what the cgroups of this process leave, in bytes,
// divided among `processes` like this one. Without either figure there is no limit.
std::uint64_t default_memory_limit(std::uint64_t processes = 1);

}  // namespace vdwmesh
