// Downloads large arrays from device memory to memory of the caller that has not been touched yet.
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

// Copies the parts after all work on the stream so far, and returns when they have arrived. Several
// threads take chunks in turn through page-locked memory. While one chunk is on the bus, others are
// written to the caller's pages: the first write to a page costs more than the transfer.
void download_parts(const std::vector<DownloadPart>& parts, const Stream& stream);

}  // namespace vdwmesh
