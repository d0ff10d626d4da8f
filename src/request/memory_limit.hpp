// How much memory a request may take unless told otherwise.
#pragma once

#include <cstdint>

namespace vdwmesh {

// 80 % of the least of the available memory and what the cgroups of this process leave, in bytes,
// divided among `processes` like this one. Without either figure there is no limit.
std::uint64_t default_memory_limit(std::uint64_t processes = 1);

}  // namespace vdwmesh
