// Copies of large arrays between device memory and ordinary memory of the caller.
//
// Several threads take chunks in turn through page-locked memory: while one chunk is on the bus,
// others are copied by the processor, which on one thread takes longer than the bus.
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

// Copies the parts after all work on the stream so far, and returns when they have arrived. The
// memory of the caller may be untouched: the first write to a page costs more than the transfer,
// and several threads share it.
void download_parts(const std::vector<DownloadPart>& parts, const Stream& stream);

struct UploadPart {
  void* device;
  const void* host;
  std::size_t bytes;
};

// Copies the parts after all work on the stream so far, and returns when they have arrived.
void upload_parts(const std::vector<UploadPart>& parts, const Stream& stream);

}  // namespace vdwmesh
