// The meshes of a stack of fields, extracted together into device memory.
#pragma once

#include <cstddef>
#include <vector>

#include "cuda/extract/fields.cuh"

namespace vdwmesh {

struct StackExtraction {
  DeviceMesh meshes;             // one behind the other, each numbered from 0
  std::vector<MeshSize> before;  // as BatchExtraction::before
  std::uint64_t candidates = 0;  // bricks whose nodes were looked at
  ExtractStats stats;
  ExtractTimings timings;
};

// Counts all fields, then emits all. Throws LimitExceeded for the size of one mesh, with its number
// in front of the message, where the first field is number `first_set`, and for the size of all;
// DeviceMemoryExceeded if the meshes do not fit in options.device_memory or in what is free.
StackExtraction extract_stack_on_device(const DeviceFieldStack& stack,
                                        const ExtractOptions& options, const Stream& stream,
                                        std::size_t first_set = 0);

}  // namespace vdwmesh
