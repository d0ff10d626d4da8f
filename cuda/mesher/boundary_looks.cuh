// First looks at boundaries on a device: a kernel that looks at each with one thread, and the
// batches in which boundaries get there (creases/share/look_batch.hpp).
#pragma once

#include <cstdint>

#include "creases/share/patch_device.hpp"

namespace vdwmesh::mesher {

// Does what PatchDevice::look() says on the current device, with up to so many bytes of its memory.
void look_at_boundaries(const LookOrder& order, std::uint64_t most_bytes);

}  // namespace vdwmesh::mesher
