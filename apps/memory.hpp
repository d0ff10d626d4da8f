// How much memory a run may take unless told otherwise.
#pragma once

#include <cstdint>

namespace vdwmesh::apps {

// 80 % of the least of the available memory and what the cgroups of this process leave, in bytes.
// Without either figure there is no limit.
std::uint64_t default_memory_limit();

}  // namespace vdwmesh::apps
