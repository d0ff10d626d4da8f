// From device memory to memory of the caller that nobody has touched yet.
#pragma once

#include <cstddef>
#include <vector>

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

struct DownloadPart {
  void* host;
  const void* device;
  std::size_t bytes;
};

// Copies the parts, after the work on the stream so far, and returns when they are there. Several
// threads take chunks in turn through page-locked memory: while one chunk is on the bus, others are
// written to the caller's pages, whose first touch costs more than the bus.
void download_parts(const std::vector<DownloadPart>& parts, const Stream& stream);

}  // namespace vdwmesh
