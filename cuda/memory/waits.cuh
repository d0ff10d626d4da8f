// Ways to wait for the work of a stream.
#pragma once

#include "cuda/memory/device_memory.cuh"

namespace vdwmesh {

// Waits asleep, some tens of microseconds longer than Stream::wait(), which keeps a processor busy:
// for long work, while other threads compute.
inline void wait_asleep(const Stream& stream) {
  const Event end(cudaEventBlockingSync | cudaEventDisableTiming);
  end.record(stream);
  end.wait();
}

// Waits for a stream when it is destroyed, whatever has happened: made before work that looks at
// memory which is given back in the order of another stream.
class WaitAtEnd {
 public:
  explicit WaitAtEnd(const Stream& stream) : stream_(stream) {}
  ~WaitAtEnd() { cudaStreamSynchronize(stream_); }
  WaitAtEnd(const WaitAtEnd&) = delete;
  WaitAtEnd& operator=(const WaitAtEnd&) = delete;

 private:
  cudaStream_t stream_;
};

}  // namespace vdwmesh
